//! Whole fits of tiny, empty, noisy and extremely shaped pictures, judged by the files that they write.

use super::{Check, Extent, Observation};
use strokefit::Result;
use strokefit::fit::{Budget, Config, Execution, Fit, Fitter, Preset};
use strokefit::image::Image;
use strokefit::metrics;
use strokefit::rng;
use strokefit::scene::Mark;
use strokefit::svg::{self, WriteOptions};
use strokefit::verify::{self, Verdict};

/// Numbers of threads that have to give the same bytes; the first is run twice.
const THREADS: [usize; 4] = [1, 1, 2, 3];

/// A drawing's mean squared error in units of that of the best page of one colour: no drawing may be
/// worse. The slack is for a colour that is rounded to 8 bits.
const NO_WORSE: f64 = 1.01;
/// And this much more: an 8-bit level, which a value between two levels may be off by.
const ROUNDING: f64 = 1.0 / (255.0 * 255.0);

/// Least agreement, dB, of a picture that is a known exception to the bound of ordinary drawings: 26 levels
/// root mean square.
const MIN_EXCEPTION_DB: f64 = 20.0;

pub(super) fn checks(extent: Extent, given: &[(String, Image)]) -> Vec<Check<'_>> {
    let strokes = match extent {
        Extent::Short => 30,
        Extent::Full => 300,
    };
    let made = hard().into_iter().map(move |hard| {
        Check::new("pictures", hard.name, hard.what, move || {
            finding(&(hard.picture)()?, strokes, hard.exception)
        })
    });
    let given = given.iter().map(move |(name, picture)| {
        let what = format!("a picture of {}×{} px", picture.width(), picture.height());
        Check::new("pictures", name.clone(), what, move || {
            finding(picture, strokes, "")
        })
    });
    made.chain(given).collect()
}

type Make = Box<dyn Fn() -> Result<Image>>;

/// A picture of one kind of trouble.
struct HardPicture {
    name: &'static str,
    what: &'static str,
    picture: Make,
    exception: &'static str,
}

impl HardPicture {
    fn new(name: &'static str, what: &'static str, picture: Make) -> Self {
        Self {
            name,
            what,
            picture,
            exception: "",
        }
    }
}

const THIN: &str = "strokes of 1.02 px at 45° in the highest contrast fill the picture, and each is drawn some 19 \
                    levels off: see agreement";

fn hard() -> Vec<HardPicture> {
    let gray = |width: usize, height: usize, f: fn(usize, usize) -> f32| -> Make {
        Box::new(move || make(width, height, |x, y| [f(x, y); 3]))
    };
    let rgb = |width: usize, height: usize, f: fn(usize, usize) -> [f32; 3]| -> Make {
        Box::new(move || make(width, height, f))
    };
    vec![
        HardPicture::new("1x1", "one pixel", rgb(1, 1, |_, _| [0.2, 0.6, 0.4])),
        HardPicture::new("1x4096", "a column of noise", rgb(1, 4096, noise)),
        HardPicture::new("4096x1", "a row of noise", rgb(4096, 1, noise)),
        HardPicture::new(
            "flat",
            "one colour",
            rgb(48, 40, |_, _| [77.0, 128.0, 179.0].map(|v: f32| v / 255.0)),
        ),
        HardPicture::new("black", "black", gray(48, 40, |_, _| 0.0)),
        HardPicture::new("white", "white", gray(48, 40, |_, _| 1.0)),
        HardPicture {
            exception: THIN,
            ..HardPicture::new(
                "checkerboard",
                "squares of 1 px",
                gray(48, 40, |x, y| ((x + y) % 2) as f32),
            )
        },
        HardPicture::new(
            "bright-pixel",
            "one white pixel on black",
            gray(48, 40, |x, y| f32::from(u8::from((x, y) == (20, 17)))),
        ),
        HardPicture::new(
            "steep-gradients",
            "ramps from black to white within 8 px, jumps between",
            gray(64, 48, |x, _| (x % 8) as f32 / 7.0),
        ),
        HardPicture::new("noise", "pure noise", rgb(64, 48, noise)),
        HardPicture::new(
            "saturated",
            "the eight corners of the colour cube",
            rgb(64, 48, |x, y| {
                let corner = x / 16 + 4 * (y / 24);
                [corner & 1, corner >> 1 & 1, corner >> 2 & 1].map(|c| c as f32)
            }),
        ),
        HardPicture::new(
            "16-bit",
            "a ramp of 3,072 levels between two of 8 bits",
            gray(64, 48, |x, y| {
                (128.0 + (y * 64 + x) as f32 / 3072.0) / 255.0
            }),
        ),
    ]
}

fn make(width: usize, height: usize, f: impl Fn(usize, usize) -> [f32; 3]) -> Result<Image> {
    let pixels: Vec<_> = (0..width * height)
        .map(|i| f(i % width, i / width))
        .collect();
    let plane = |c: usize| pixels.iter().map(|rgb| rgb[c]).collect();
    Image::new(width, height, [plane(0), plane(1), plane(2)])
}

fn noise(x: usize, y: usize) -> [f32; 3] {
    [0, 1, 2].map(|c| rng::draw(11, x as u64, y as u64, c))
}

/// Checks that a drawing of the picture is sound; resvg may draw it otherwise than it was fitted if there is an
/// `exception` for that.
fn finding(picture: &Image, strokes: usize, exception: &'static str) -> Result<Observation> {
    let config = Config {
        budget: Budget {
            strokes: Some(strokes),
            ..Budget::default()
        },
        preset: Preset::Draft,
        ..Config::default()
    };
    let drawn = THREADS.map(|threads| drawn(picture, &config, threads));
    let mut texts = Vec::new();
    for drawn in &drawn {
        match drawn {
            Ok((_, text)) => texts.push(text.as_str()),
            Err(error) => return Ok(Observation::new(error.to_string(), false)),
        }
    }
    let identical = texts.windows(2).all(|pair| pair[0] == pair[1]);
    match &drawn[0] {
        Ok((fit, text)) => sound(fit, text).map(|sound| sound.finding(identical, exception)),
        Err(error) => Ok(Observation::new(error.to_string(), false)),
    }
}

fn drawn(picture: &Image, config: &Config, threads: usize) -> Result<(Fit, String)> {
    let execution = Execution {
        threads: Some(threads),
        ..Execution::default()
    };
    let fit = Fitter::new(config.clone())
        .execution(execution)
        .fit(picture)?;
    let text = svg::write(&fit.scene, &WriteOptions::default());
    Ok((fit, text))
}

/// Properties of a drawing that make it sound.
pub(super) struct Sound {
    strokes: usize,
    verdict: Verdict,
    /// The file is what was fitted, and every number of drawing and render is finite.
    finite: bool,
    /// No worse than a page of one colour.
    useful: bool,
}

/// Looks at a drawing and its file.
pub(super) fn sound(fit: &Fit, text: &str) -> Result<Sound> {
    let verdict = verify::verify(text, &fit.target, &fit.soft)?;
    let back = svg::read(text)?;
    let soft = fit.soft.planes().iter().flatten().all(|v| v.is_finite());
    let strokes = fit.scene.marks().all(Mark::is_finite);
    let flat = flat_error(&fit.target)?;
    Ok(Sound {
        strokes: back.len(),
        verdict,
        finite: back == fit.scene && soft && strokes,
        useful: verdict.fidelity.mse <= NO_WORSE * flat + ROUNDING,
    })
}

/// The mean squared error of the page in the picture's mean colour.
fn flat_error(target: &Image) -> Result<f64> {
    let mean = target.planes().each_ref().map(|plane| {
        let sum: f64 = plane.iter().map(|&v| f64::from(v)).sum();
        (sum / plane.len() as f64) as f32
    });
    metrics::mse(
        target,
        &Image::filled(target.width(), target.height(), mean)?,
    )
}

impl Sound {
    pub(super) fn holds(&self) -> bool {
        self.is_valid() && self.useful
    }

    /// True if it can be drawn as it was fitted, good or bad.
    pub(super) fn is_valid(&self) -> bool {
        self.finite && self.verdict.agrees()
    }

    fn finding(&self, identical: bool, exception: &'static str) -> Observation {
        let bytes = if identical { "the same" } else { "DIFFERENT" };
        let figure = format!("{self}; {bytes} bytes on 1, 1, 2 and 3 threads");
        let finding = Observation::new(figure, self.holds() && identical);
        let nearly = self.verdict.agreement.psnr_db >= MIN_EXCEPTION_DB;
        if self.finite && self.useful && identical && nearly {
            finding.excepting(exception)
        } else {
            finding
        }
    }
}

impl std::fmt::Display for Sound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Verdict {
            fidelity,
            agreement,
        } = self.verdict;
        write!(
            f,
            "{} strokes, fidelity {:.1} dB, agreement {:.1} dB",
            self.strokes, fidelity.psnr_db, agreement.psnr_db
        )?;
        if !self.finite {
            f.write_str(", NOT FINITE or not as fitted")?;
        }
        if !self.useful {
            f.write_str(", WORSE than one colour")?;
        }
        Ok(())
    }
}
