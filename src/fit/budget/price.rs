//! The price of a stroke: the squared error that its bytes have to remove.

use crate::fit::config::{Config, DEFAULT_QUALITY};
use crate::fit::drawing::Drawing;
use crate::math;
use crate::render::{Params, StrokeRef, Strokes};
use crate::scene::{Mark, PointKind};
use crate::svg::{Form, WriteOptions, mark_bytes};

/// The price of strokes and points, as squared error summed over pixels and channels.
///
/// Squared error below that of the quality counts less and less: of E, the squared error at the quality, and e < E, the
/// drawing's own, a small gain counts e/E of itself, so that e in all counts E/2 + e²/2E. A drawing that is better than
/// wanted needs no strokes for errors that nobody sees. Above E every gain counts in full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::fit) struct Price {
    per_byte: f32,
    /// The mean squared error of the quality.
    wanted_mse: f64,
    /// The drawing's squared error and that at the quality.
    errors: Option<[f64; 2]>,
    /// The price of a stroke's bytes, in units of the price of a point's.
    of_strokes: f32,
    /// The price of the bytes of areas and of their points, in units of the price of other bytes.
    of_areas: f32,
    file: WriteOptions,
}

/// Doubt, levels, at which a byte has to remove twice the squared error. 2.5: JPEG 75 and noise of 8 levels cost 3 dB of quality, with
/// which 20 drawings and icons have 1.07 and 1.00 times the numbers of the clean picture in the median.
const DOUBLE: f32 = 2.5;
/// The quality that sets the price of points where a fidelity is asked for, dB beyond that fidelity. A guess.
const BEYOND_DB: f64 = 6.0;
/// The price of the bytes of areas, in units of that of strokes' bytes. Errors of areas lie along edges, where people see them. A
/// quarter instead of 0.35: 41 drawings of filled shapes, +0.1 dB for 1 % more bytes.
const AREA_PRICE: f32 = 0.25;
/// The price of a stroke's bytes where a fidelity is asked for, in units of that of a point's: as many strokes come as it takes, but
/// none that draws nothing. A guess.
const STROKE_PRICE: f32 = 0.1;

impl Price {
    /// At quality `q` each byte has to remove as much squared error as one pixel has at `q` dB: 3·10^(−q/10). Without a
    /// quality strokes are free.
    pub(in crate::fit) fn new(quality: Option<f64>, file: WriteOptions) -> Self {
        let wanted_mse = quality.map_or(0.0, mse);
        Self {
            per_byte: 3.0 * wanted_mse as f32,
            wanted_mse,
            errors: None,
            of_strokes: 1.0,
            of_areas: 1.0,
            file,
        }
    }

    /// The price of what `config` draws of a picture of `pixels` pixels: that of its quality, or of a fidelity, to be met by few
    /// strokes of not too many points. Damage takes from the quality, and paleness adds to it, unless the user has set that:
    /// the picture is `doubt` levels from what it means.
    pub(in crate::fit) fn of(config: &Config, doubt: f32, paleness_db: f64, pixels: usize) -> Self {
        let lost_db = match config.quality {
            None => 10.0 * math::log10(1.0 + f64::from(doubt / DOUBLE)) - paleness_db,
            Some(_) => 0.0,
        };
        let wanted_db = config.budget.psnr_db.map(|db| db + BEYOND_DB);
        // Price by the plain form unless bytes are limited: cheaper bytes in the smallest form mustn't buy more marks.
        let form = match config.file.form {
            Form::Smallest if config.budget.bytes.is_none() => Form::Plain,
            form => form,
        };
        let file = WriteOptions {
            form,
            ..config.file
        };
        let price = match config.quality_for(pixels) {
            // A large picture has a lower price for each pixel, but people see its errors as well.
            Some(quality) => Self {
                wanted_mse: mse(config.quality.unwrap_or(DEFAULT_QUALITY) - lost_db),
                ..Self::new(Some(quality - lost_db), file)
            },
            None => Self {
                of_strokes: STROKE_PRICE,
                ..Self::new(wanted_db, file)
            },
        };
        Self {
            of_areas: AREA_PRICE,
            ..price
        }
    }

    /// The price of a byte.
    pub(in crate::fit) fn per_byte(&self) -> f32 {
        self.per_byte
    }

    /// The squared error of a file of `pixels` pixels and mean squared error `mse`, as far as it counts, and the price of its
    /// `bytes`; `None` if bytes are free.
    pub(in crate::fit) fn cost(&self, mse: f64, pixels: usize, bytes: usize) -> Option<f64> {
        let values = 3.0 * pixels as f64;
        let error = counted(mse * values, self.wanted_mse * values);
        (self.per_byte > 0.0).then(|| error + f64::from(self.of_bytes(bytes)))
    }

    /// The price at a quality that is higher by `db`.
    pub(in crate::fit) fn eased(self, db: f64) -> Self {
        Self {
            per_byte: self.per_byte * mse(db) as f32,
            wanted_mse: self.wanted_mse * mse(db),
            ..self
        }
    }

    /// The price with bytes of areas as dear as others, to choose between areas and strokes.
    pub(in crate::fit) fn of_bytes_alone(self) -> Self {
        Self {
            of_areas: 1.0,
            ..self
        }
    }

    /// The price in `drawing` as it is.
    pub(in crate::fit) fn in_drawing(self, drawing: &mut Drawing) -> Self {
        // Free bytes are free in every drawing, so none need be rendered.
        if self.per_byte == 0.0 {
            return self;
        }
        self.at(drawing.mse(), drawing.pixels())
    }

    /// The price in a drawing of `pixels` pixels and mean squared error `mse`.
    fn at(self, mse: f64, pixels: usize) -> Self {
        let values = 3.0 * pixels as f64;
        Self {
            errors: Some([mse * values, self.wanted_mse * values]),
            ..self
        }
    }

    /// The least squared error that something of this price has to remove to come.
    fn add_threshold(&self, price: f32) -> f32 {
        let Some([error, wanted]) = self.errors.filter(|_| price > 0.0) else {
            return price;
        };
        // Adding pays if counted(error) − counted(error − gain) ≥ price, which is solved for the gain. If even a perfect drawing
        // would gain less, nothing does.
        let left = counted(error, wanted) - f64::from(price);
        uncounted(left, wanted).map_or(f32::INFINITY, |left| (error - left) as f32)
    }

    /// The least squared error that something of this price has to spare to stay.
    fn keep_threshold(&self, price: f32) -> f32 {
        let Some([error, wanted]) = self.errors.filter(|_| price > 0.0) else {
            return price;
        };
        // Removing pays if counted(error + contribution) − counted(error) ≤ price. Below the quality a stroke may be worth more than its
        // price and go: its error counts for less there.
        let without = counted(error, wanted) + f64::from(price);
        uncounted(without, wanted).map_or(0.0, |without| (without - error) as f32)
    }

    fn of_bytes(&self, bytes: usize) -> f32 {
        self.per_byte * bytes as f32
    }

    /// The least contribution of `stroke` to stay.
    pub(in crate::fit) fn least_contribution(&self, stroke: StrokeRef<'_>) -> f32 {
        if self.per_byte == 0.0 {
            return 0.0;
        }
        let factor = self.factor(stroke.is_area());
        self.keep_threshold(factor * self.of_strokes * self.of_bytes(self.bytes_of(stroke)))
    }

    /// The least gain of `mark` to be added.
    pub(in crate::fit) fn least_gain(&self, mark: &Mark) -> f32 {
        if self.per_byte == 0.0 {
            return 0.0;
        }
        let factor = self.factor(mark.as_area().is_some());
        self.add_threshold(factor * self.of_strokes * self.of_bytes(mark_bytes(mark, &self.file)))
    }

    /// The least gain of a capsule to be added.
    pub(in crate::fit) fn least_gain_of_capsule(&self, capsule: &Params) -> f32 {
        self.least_gain(&Strokes::from_iter([capsule]).get(0).to_mark())
    }

    /// The least gains of a point of a stroke, or of an area, to be added and to stay.
    pub(in crate::fit) fn of_point(&self, of_area: bool) -> [f32; 2] {
        let price = self.factor(of_area) * self.of_bytes(self.point_bytes());
        [self.add_threshold(price), self.keep_threshold(price)]
    }

    /// The squared error that may be added to save this many bytes of areas.
    pub(in crate::fit) fn of_saved(&self, bytes: usize) -> f32 {
        self.keep_threshold(self.of_areas * self.of_bytes(bytes))
    }

    fn factor(&self, of_area: bool) -> f32 {
        if of_area { self.of_areas } else { 1.0 }
    }

    /// Bytes of a stroke.
    pub(in crate::fit) fn bytes_of(&self, stroke: StrokeRef<'_>) -> usize {
        mark_bytes(&stroke.to_mark(), &self.file)
    }

    /// Bytes that one more point adds to a typical stroke.
    pub(in crate::fit) fn point_bytes(&self) -> usize {
        let bytes = |points: &[[f32; 2]]| {
            self.bytes_of(StrokeRef {
                points,
                kinds: &[PointKind::On; 3][..points.len()],
                closed: false,
                rings: &[],
                form: None,
                paint: None,
                sweep: None,
                style: &[1.67, 0.4, 0.5, 0.6, 1.0],
            })
        };
        // In the middle of the file's numbers: steps of some px, with one sign of two.
        let points = [[123.46, 78.91], [127.82, 74.57], [134.24, 76.35]];
        // The bytes of the third point. At least 1, as it is a divisor.
        bytes(&points).saturating_sub(bytes(&points[..2])).max(1)
    }
}

/// The mean squared error of a fidelity, dB.
fn mse(psnr_db: f64) -> f64 {
    math::powf(10.0, -psnr_db / 10.0)
}

/// Counted part of a squared error; `wanted` is the one at the quality.
fn counted(error: f64, wanted: f64) -> f64 {
    if error < wanted {
        // The slope is error / wanted, so it joins the straight part at `wanted` in value and in slope.
        0.5 * (wanted + error * error / wanted)
    } else {
        error
    }
}

/// The squared error that counts `count`; `None` if none counts so little.
fn uncounted(count: f64, wanted: f64) -> Option<f64> {
    match 2.0 * count - wanted {
        _ if count >= wanted => Some(count),
        // The inverse of ½(wanted + e² / wanted). No error counts less than ½ wanted.
        twice if twice >= 0.0 => Some((twice * wanted).sqrt()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STROKE: Params = [10.0, 10.0, 20.0, 14.0, 2.0, 0.5, 0.25, 0.75, 1.0];

    fn price(quality: Option<f64>) -> Price {
        Price::new(quality, WriteOptions::default())
    }

    fn capsule(price: &Price) -> f32 {
        price.least_gain_of_capsule(&STROKE)
    }

    #[test]
    fn ten_db_are_a_tenth_of_the_price() {
        let (dear, cheap) = (price(Some(20.0)), price(Some(30.0)));
        assert!((capsule(&dear) / capsule(&cheap) - 10.0).abs() < 1e-3);
    }

    #[test]
    fn without_a_quality_strokes_are_free() {
        assert_eq!(capsule(&price(None)), 0.0);
        assert_eq!(capsule(&price(None).at(0.01, 100)), 0.0);
    }

    #[test]
    fn prices_rise_beyond_the_quality() {
        let price = price(Some(30.0));
        let at = |db: f64| price.at(math::powf(10.0, -db / 10.0), 10_000);
        assert!((capsule(&at(20.0)) / capsule(&price) - 1.0).abs() < 1e-3);
        assert!(capsule(&at(36.0)) > 2.0 * capsule(&price));
        // A drawing with less error in all than a stroke would have to remove gets no stroke.
        assert_eq!(capsule(&at(60.0)), f32::INFINITY);
    }

    #[test]
    fn what_a_drawing_stands_on_stays_however_good_it_is() {
        let strokes = Strokes::from_iter([&STROKE]);
        let price = price(Some(30.0)).at(1e-9, 10_000);
        let least = price.least_contribution(strokes.get(0));
        assert!(least > 0.0 && least < 10.0, "{least}");
    }

    #[test]
    fn counting_is_undone() {
        for error in [0.0, 0.3, 1.9, 2.0, 7.0] {
            let again = uncounted(counted(error, 2.0), 2.0).unwrap();
            assert!((again - error).abs() < 1e-9, "{again} of {error}");
        }
        assert_eq!(uncounted(0.9, 2.0), None);
    }
}
