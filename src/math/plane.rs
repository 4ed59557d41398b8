//! Points and displacements of the plane.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, Neg, Sub};

/// A point of the picture plane in px; x to the right, y down, pixel centres at +0.5.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// To the right.
    pub x: f32,
    /// Down.
    pub y: f32,
}

/// A displacement in the picture plane in px.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vector {
    /// To the right.
    pub x: f32,
    /// Down.
    pub y: f32,
}

impl Point {
    /// The point (0, 0).
    pub fn origin() -> Self {
        Self::new(0.0, 0.0)
    }

    /// Where it is from the origin.
    #[inline]
    pub fn coords(self) -> Vector {
        Vector::new(self.x, self.y)
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

impl Vector {
    /// No displacement.
    #[inline]
    pub fn zeros() -> Self {
        Self::new(0.0, 0.0)
    }

    /// The scalar product.
    #[inline]
    pub fn dot(&self, other: &Self) -> f32 {
        self.x * other.x + self.y * other.y
    }

    /// The scalar product with `other` turned by a right angle: above 0 where it lies clockwise, as y points down.
    #[inline]
    pub fn perp(&self, other: &Self) -> f32 {
        self.x * other.y - self.y * other.x
    }

    /// The square of the length.
    #[inline]
    pub fn norm_squared(&self) -> f32 {
        self.dot(self)
    }

    /// The length.
    #[inline]
    pub fn norm(&self) -> f32 {
        self.norm_squared().sqrt()
    }

    /// This direction at length 1; `None` up to the length `least`.
    #[inline]
    pub fn try_normalize(&self, least: f32) -> Option<Self> {
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
    pub fn min(&self) -> f32 {
        self.x.min(self.y)
    }

    /// The greater coordinate.
    #[inline]
    pub fn max(&self) -> f32 {
        self.x.max(self.y)
    }

    /// The longer of the distances along the axes.
    #[inline]
    pub fn amax(&self) -> f32 {
        self.abs().max()
    }
}

/// Items that both have as pairs of numbers.
macro_rules! pair {
    ($($pair:ident)*) => {$(
        impl $pair {
            /// From both coordinates.
            #[inline]
            pub const fn new(x: f32, y: f32) -> Self {
                Self { x, y }
            }
        }

        impl From<[f32; 2]> for $pair {
            #[inline]
            fn from([x, y]: [f32; 2]) -> Self {
                Self { x, y }
            }
        }

        impl From<$pair> for [f32; 2] {
            #[inline]
            fn from(pair: $pair) -> Self {
                [pair.x, pair.y]
            }
        }

        impl Index<usize> for $pair {
            type Output = f32;

            #[inline]
            fn index(&self, axis: usize) -> &f32 {
                [&self.x, &self.y][axis]
            }
        }

        impl IndexMut<usize> for $pair {
            #[inline]
            fn index_mut(&mut self, axis: usize) -> &mut f32 {
                let Self { x, y } = self;
                if axis == 0 { x } else { y }
            }
        }
    )*};
}

pair! { Point Vector }

impl From<Vector> for Point {
    /// The point there from the origin.
    #[inline]
    fn from(place: Vector) -> Self {
        Self::new(place.x, place.y)
    }
}

/// Sums and differences, coordinate by coordinate.
macro_rules! sums {
    ($($left:ident $operator:ident $method:ident $right:ident = $sum:ident;)*) => {$(
        impl $operator<$right> for $left {
            type Output = $sum;

            #[inline]
            fn $method(self, other: $right) -> $sum {
                $sum::new(self.x.$method(other.x), self.y.$method(other.y))
            }
        }
    )*};
}

sums! {
    Point Add add Vector = Point;
    Point Sub sub Vector = Point;
    Point Sub sub Point = Vector;
    Vector Add add Vector = Vector;
    Vector Sub sub Vector = Vector;
}

impl Mul<f32> for Vector {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

impl Div<f32> for Vector {
    type Output = Self;

    #[inline]
    fn div(self, divisor: f32) -> Self {
        Self::new(self.x / divisor, self.y / divisor)
    }
}

impl Neg for Vector {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

impl AddAssign for Vector {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
