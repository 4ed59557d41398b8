//! Points and displacements of the plane.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, Neg, Sub};

use super::Real;

/// A place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point2<T> {
    /// To the right.
    pub x: T,
    /// Down.
    pub y: T,
}

/// A displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vector2<T> {
    /// To the right.
    pub x: T,
    /// Down.
    pub y: T,
}

impl<T: Real> Point2<T> {
    /// The point (0, 0).
    pub fn origin() -> Self {
        Self::new(T::zero(), T::zero())
    }

    /// Where it is from the origin.
    #[inline]
    pub fn coords(self) -> Vector2<T> {
        Vector2::new(self.x, self.y)
    }

    /// The upper left corner of the box around both.
    #[inline]
    pub fn inf(&self, other: &Self) -> Self {
        Self::new(self.x.min(other.x), self.y.min(other.y))
    }

    /// The lower right corner of the box around both.
    #[inline]
    pub fn sup(&self, other: &Self) -> Self {
        Self::new(self.x.max(other.x), self.y.max(other.y))
    }
}

impl<T: Real> Vector2<T> {
    /// No displacement.
    #[inline]
    pub fn zeros() -> Self {
        Self::new(T::zero(), T::zero())
    }

    /// The scalar product.
    #[inline]
    pub fn dot(&self, other: &Self) -> T {
        self.x * other.x + self.y * other.y
    }

    /// The scalar product with `other` turned by a right angle: above 0 where it lies clockwise, as y points down.
    #[inline]
    pub fn perp(&self, other: &Self) -> T {
        self.x * other.y - self.y * other.x
    }

    /// The square of the length.
    #[inline]
    pub fn norm_squared(&self) -> T {
        self.dot(self)
    }

    /// The length.
    #[inline]
    pub fn norm(&self) -> T {
        self.norm_squared().sqrt()
    }

    /// This direction at length 1; `None` up to the length `least`.
    #[inline]
    pub fn try_normalize(&self, least: T) -> Option<Self> {
        let norm = self.norm();
        // A length that is no number is not small.
        let is_small = norm <= least;
        (!is_small).then(|| *self / norm)
    }

    /// The distances along the axes.
    #[inline]
    pub fn abs(&self) -> Self {
        Self::new(self.x.abs(), self.y.abs())
    }

    /// The lesser coordinate.
    #[inline]
    pub fn min(&self) -> T {
        self.x.min(self.y)
    }

    /// The greater coordinate.
    #[inline]
    pub fn max(&self) -> T {
        self.x.max(self.y)
    }

    /// The longer of the distances along the axes.
    #[inline]
    pub fn amax(&self) -> T {
        self.abs().max()
    }
}

/// Items that both have as pairs of numbers.
macro_rules! pair {
    ($($pair:ident)*) => {$(
        impl<T> $pair<T> {
            /// From both coordinates.
            #[inline]
            pub const fn new(x: T, y: T) -> Self {
                Self { x, y }
            }
        }

        impl<T> From<[T; 2]> for $pair<T> {
            #[inline]
            fn from([x, y]: [T; 2]) -> Self {
                Self { x, y }
            }
        }

        impl<T> From<$pair<T>> for [T; 2] {
            #[inline]
            fn from(pair: $pair<T>) -> Self {
                [pair.x, pair.y]
            }
        }

        impl<T> Index<usize> for $pair<T> {
            type Output = T;

            #[inline]
            fn index(&self, axis: usize) -> &T {
                [&self.x, &self.y][axis]
            }
        }

        impl<T> IndexMut<usize> for $pair<T> {
            #[inline]
            fn index_mut(&mut self, axis: usize) -> &mut T {
                let Self { x, y } = self;
                if axis == 0 { x } else { y }
            }
        }
    )*};
}

pair! { Point2 Vector2 }

impl<T> From<Vector2<T>> for Point2<T> {
    /// The point there from the origin.
    #[inline]
    fn from(place: Vector2<T>) -> Self {
        Self::new(place.x, place.y)
    }
}

/// Sums and differences, coordinate by coordinate.
macro_rules! sums {
    ($($left:ident $operator:ident $method:ident $right:ident = $sum:ident;)*) => {$(
        impl<T: Real> $operator<$right<T>> for $left<T> {
            type Output = $sum<T>;

            #[inline]
            fn $method(self, other: $right<T>) -> $sum<T> {
                $sum::new(self.x.$method(other.x), self.y.$method(other.y))
            }
        }
    )*};
}

sums! {
    Point2 Add add Vector2 = Point2;
    Point2 Sub sub Vector2 = Point2;
    Point2 Sub sub Point2 = Vector2;
    Vector2 Add add Vector2 = Vector2;
    Vector2 Sub sub Vector2 = Vector2;
}

impl<T: Real> Mul<T> for Vector2<T> {
    type Output = Self;

    #[inline]
    fn mul(self, factor: T) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

impl<T: Real> Div<T> for Vector2<T> {
    type Output = Self;

    #[inline]
    fn div(self, divisor: T) -> Self {
        Self::new(self.x / divisor, self.y / divisor)
    }
}

impl<T: Real> Neg for Vector2<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

impl<T: Real> AddAssign for Vector2<T> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
