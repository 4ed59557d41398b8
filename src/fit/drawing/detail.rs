//! Detail: weights of errors that destroy small things.
//!
//! A letter, a dot or a thin line takes few pixels, and so little squared error, but it is there or it is not. Errors in and
//! beside such things count more where nothing around hides them.

use crate::fit::drawing::focus::Focus;
use crate::fit::recipe::SmallThings;
use crate::image::Image;
use crate::metrics::Details;

/// Weight of an error at each pixel of `picture`, 1 where there is no small thing.
pub(in crate::fit) fn weights(picture: &Image, recipe: SmallThings) -> Focus {
    let SmallThings {
        gain,
        contrast,
        most,
    } = recipe;
    let weights = Details::of(picture).weights(gain, contrast, most);
    Focus::of_weights([picture.width(), picture.height()], weights)
}
