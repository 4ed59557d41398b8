//! Halves and doubles each tuned number of a fit, and prints the change of fidelity on some pictures.
//!
//! ```sh
//! cargo run --release --example recipe -- samples/{coffee-300,rocket-320,noto-hibiscus,bicycle}.png
//! ```
//!
//! A row is a number of [`Recipe`], its value, and the change of the mean over the pictures at half and at twice the
//! value: of the fidelity in dB, and of the bytes in per cent where the number of strokes or their forms may change.
//! [`Setting`] says what each is tried on. Other seeds move a mean by up to 0.1 dB.
#![allow(clippy::print_stdout, reason = "it is what the example is for")]

use strokefit::fit::{Budget, Colors, Config, Fitter, Recipe};
use strokefit::image::Image;
use strokefit::svg::{Form, WriteOptions};
use strokefit::verify;

/// A number of a recipe.
pub(crate) enum Number<'a> {
    Single(&'a mut f32),
    Double(&'a mut f64),
    Count(&'a mut usize),
}

impl Number<'_> {
    fn value(&self) -> String {
        match self {
            Self::Single(x) => x.to_string(),
            Self::Double(x) => x.to_string(),
            Self::Count(x) => x.to_string(),
        }
    }

    fn scale(&mut self, factor: f64) {
        match self {
            Self::Single(x) => **x *= factor as f32,
            Self::Double(x) => **x *= factor,
            Self::Count(x) => **x = (**x as f64 * factor).round() as usize,
        }
    }
}

/// Kind of fit for which a number matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Setting {
    /// 300 strokes.
    Strokes,
    /// 300 strokes in 12 colours.
    Colors,
    /// 300 opaque strokes in the smallest form.
    Pens,
    /// As many strokes as are worth their price.
    Price,
    /// 30 dB by as few strokes as may be.
    Fidelity,
}

type Access = fn(&mut Recipe) -> Number<'_>;

/// The name of a number, where it matters, and how to get at it.
pub(crate) type Row = (&'static str, Setting, Access);

/// Rows from lines of setting, kind and place of a number.
macro_rules! rows {
    ($($setting:ident $kind:ident $($field:ident).+;)*) => {
        &[$((
            stringify!($($field).+),
            Setting::$setting,
            |recipe| Number::$kind(&mut recipe.$($field).+),
        )),*]
    };
}

/// Those that a time limit alone uses are left out, and those that are no tuning but a domain.
pub(crate) const ROWS: &[Row] = rows! {
    Strokes Single probing.cells;
    Strokes Single probing.probed;
    Strokes Count stages.count;
    Strokes Double stages.growth;
    Strokes Single stages.scale;
    Strokes Count stages.iterations;
    Strokes Single stages.polished_share;
    Strokes Single stages.rates.position;
    Strokes Single stages.rates.radius;
    Strokes Single stages.rates.color;
    Strokes Single stages.rates.opacity;
    Strokes Double stages.rates.last;
    Strokes Single stages.softest;
    Strokes Single stages.min_scale;
    Strokes Double edge.final_slope;
    Strokes Single edge.annealed;
    Strokes Double background.prevailing_share;
    Strokes Single domain.margin;
    Strokes Single domain.min_opacity;
    Strokes Single optimizer.usual_radius;
    Strokes Count polish.iterations;
    Strokes Single polish.coarse_share;
    Strokes Single polish.rates.position;
    Strokes Single polish.rates.radius;
    Strokes Single polish.rates.color;
    Strokes Single polish.rates.opacity;
    Strokes Double polish.rates.last;
    Strokes Single polish.softness;
    Strokes Count relocation.every;
    Strokes Single relocation.share;
    Strokes Single relocation.scale;
    Strokes Single relocation.gain;
    Strokes Count relocation.fill;
    Strokes Single points.per_stroke;
    Strokes Single points.swapped;
    Strokes Single points.spared;
    Strokes Count settling.rounds;
    Strokes Count settling.iterations;
    Strokes Single settling.rate;
    Strokes Single settling.color_rate;
    Strokes Single settling.next_pace;
    Strokes Double settling.browser_db;
    Strokes Double settling.offset_taken;
    Strokes Double settling.share_per_db;
    Strokes Double settling.nudging.added_db;
    Strokes Count settling.nudging.sweeps;
    Strokes Count settling.nudging.tries;
    Strokes Single settling.nudging.reach_px;
    Colors Count coloring.rounds.count;
    Colors Double coloring.rounds.iterations;
    Colors Single coloring.rounds.rate;
    Colors Count coloring.quiet_rounds;
    Colors Single coloring.damping;
    Colors Count coloring.means;
    Colors Single coloring.min_shown;
    Pens Count pens.rounds.count;
    Pens Double pens.rounds.iterations;
    Pens Single pens.rounds.rate;
    Pens Double pens.share;
    Pens Single pens.ladder;
    Pens Single pens.contrast;
    Pens Count pens.window;
    Price Single tracing.min_flat_share;
    Price Single tracing.explained;
    Price Count tracing.least_area;
    Price Single tracing.pace;
    Price Single points.from;
    Price Single points.until;
    Price Single points.share;
    Price Single points.gain;
    Price Single points.smoothness;
    Price Single points.reach;
    Price Single points.shortest;
    Price Single points.joins.reach;
    Price Single points.joins.gap;
    Price Single points.joins.alike;
    Price Single points.joins.share;
    Price Double sharing.error;
    Price Count masking.window;
    Price Double masking.contrast;
    Price Double masking.ceiling;
    Price Double stages.paying_share;
    Price Count stages.first;
    Fidelity Count stages.first;
    Fidelity Double stages.polish_gain_db;
    Fidelity Count correction.count;
    Fidelity Double correction.db_per_doubling;
    Fidelity Double correction.excess_db;
    Fidelity Double correction.polish_share;
};

/// The configuration that a number is tried under.
fn config(setting: Setting, recipe: Recipe) -> Config {
    let strokes = Budget {
        strokes: Some(300),
        ..Budget::default()
    };
    let plain = Config {
        budget: strokes,
        recipe: Some(recipe),
        ..Config::default()
    };
    match setting {
        Setting::Strokes => plain,
        Setting::Price => Config {
            budget: Budget::default(),
            ..plain
        },
        Setting::Colors => Config {
            colors: Colors::AtMost(12),
            ..plain
        },
        Setting::Pens => Config {
            opaque: true,
            file: WriteOptions {
                form: Form::Smallest,
                ..WriteOptions::default()
            },
            ..plain
        },
        Setting::Fidelity => Config {
            budget: Budget {
                psnr_db: Some(30.0),
                ..Budget::default()
            },
            ..plain
        },
    }
}

/// Mean fidelity of the files in dB, and of the logarithm of their bytes.
pub(crate) fn measure(
    pictures: &[Image],
    setting: Setting,
    recipe: Recipe,
) -> strokefit::Result<[f64; 2]> {
    let mut sums = [0.0; 2];
    for picture in pictures {
        let fit = Fitter::new(config(setting, recipe)).fit(picture)?;
        let text = fit.svg();
        sums[0] += verify::fidelity(&text, &fit.target)?.psnr_db;
        sums[1] += (text.len() as f64).ln();
    }
    Ok(sums.map(|sum| sum / pictures.len() as f64))
}

/// The change that `factor` times a number makes of the means `usual`; `None` where no fit runs with it.
pub(crate) fn change(
    pictures: &[Image],
    (_, setting, access): &Row,
    usual: [f64; 2],
    factor: f64,
) -> Option<[f64; 2]> {
    let mut recipe = Recipe::of(Default::default());
    access(&mut recipe).scale(factor);
    let changed = measure(pictures, *setting, recipe).ok()?;
    Some([
        changed[0] - usual[0],
        100.0 * ((changed[1] - usual[1]).exp() - 1.0),
    ])
}

#[allow(dead_code, reason = "the tests call `change`")]
fn main() -> strokefit::Result<()> {
    let paths = std::env::args().skip(1);
    let pictures = paths.map(Image::open).collect::<Result<Vec<_>, _>>()?;
    let mut usual: Option<(Setting, [f64; 2])> = None;
    println!("| number | value | half | twice |\n| --- | --- | --- | --- |");
    for row @ (name, setting, access) in ROWS {
        let mut recipe = Recipe::of(Default::default());
        let value = access(&mut recipe).value();
        let means = match usual.filter(|(of, _)| of == setting) {
            Some((_, means)) => means,
            None => measure(&pictures, *setting, Recipe::of(Default::default()))?,
        };
        usual = Some((*setting, means));
        let cell = |factor| match change(&pictures, row, means, factor) {
            None => "refused".into(),
            Some([db, _]) if matches!(setting, Setting::Strokes | Setting::Colors) => {
                format!("{db:+.2} dB")
            }
            Some([db, bytes]) => format!("{db:+.2} dB, {bytes:+.1} % bytes"),
        };
        println!("| {name} | {value} | {} | {} |", cell(0.5), cell(2.0));
    }
    Ok(())
}
