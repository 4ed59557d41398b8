"""What strokes and areas have in common: they are items one by one, and columns all at once."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar, Union, overload

if TYPE_CHECKING:
    from numpy.typing import NDArray

Item = TypeVar("Item")


class Columns(Sequence[Item]):
    """Items that are stored as read-only columns."""

    #: The items in words.
    _noun: ClassVar[str]

    @staticmethod
    def _freeze(columns: Sequence[NDArray[Any]]) -> None:
        for column in columns:
            column.flags.writeable = False

    @abstractmethod
    def _item(self, i: int) -> Item:
        """Item `i`, of 0 to the number of items."""

    @overload
    def __getitem__(self, index: int) -> Item: ...
    @overload
    def __getitem__(self, index: slice) -> list[Item]: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Item, list[Item]]:
        if isinstance(index, slice):
            return [self._item(i) for i in range(*index.indices(len(self)))]
        return self._item(range(len(self))[index])

    def __iter__(self) -> Iterator[Item]:
        return (self._item(i) for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} {self._noun}>"
