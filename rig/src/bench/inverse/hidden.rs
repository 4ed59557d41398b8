//! Hidden parts: how near what an element hides beneath others is to what the artist's element hides.
//!
//! The reach of an element is where it changes the picture of what lies below it; what it changes in the whole picture is
//! seen, and the rest of its reach is hidden. An element of the file and one of the artist's are the same thing if what is
//! seen of them overlaps the most.

use super::anatomy::elements;
use super::belonging::{CHANGED, MOST, drawn, without};
use crate::report::cases::Hidden;
use strokefit::Result;
use strokefit::verify::Size;

/// Least overlap of what is seen of two elements that are the same thing, in units of what is seen of either. A guess.
const SAME: f64 = 0.5;
/// Least hidden part of an element that counts, as a share of the picture: less is where edges overlap.
const LEAST: f64 = 0.001;

/// Pixels of one element.
#[derive(Debug, Default)]
struct Reach {
    seen: Vec<usize>,
    hidden: Vec<usize>,
}

/// The reaches of the elements of an artist's file.
#[derive(Debug)]
pub(super) struct Reaches {
    size: Size,
    pixels: usize,
    list: Vec<Reach>,
}

impl Reaches {
    /// The reaches of the elements of SVG text in a picture of so many px; `None` if there are too many.
    ///
    /// They take two renders for each element.
    ///
    /// # Errors
    /// As [`verify::render`](strokefit::verify::render).
    pub(super) fn of(svg: &str, size: Size) -> Result<Option<Self>> {
        let ranges = elements(svg)?;
        if ranges.len() > MOST {
            return Ok(None);
        }
        let whole = drawn(svg, size)?;
        let pixels = whole.len();
        let mut list = Vec::new();
        let mut below = drawn(&without(svg, &ranges), size)?;
        for (i, range) in ranges.iter().enumerate() {
            let on_top = drawn(&without(svg, &ranges[i + 1..]), size)?;
            let left_out = drawn(&without(svg, std::slice::from_ref(range)), size)?;
            let mut reach = Reach::default();
            for pixel in 0..pixels {
                if is_changed(&whole[pixel], &left_out[pixel]) {
                    reach.seen.push(pixel);
                } else if is_changed(&below[pixel], &on_top[pixel]) {
                    reach.hidden.push(pixel);
                }
            }
            list.push(reach);
            below = on_top;
        }
        Ok(Some(Self { size, pixels, list }))
    }

    /// What is hidden in other SVG text beside what is hidden here; `None` if that is too little, or the text has too many elements.
    ///
    /// # Errors
    /// As [`Reaches::of`].
    pub(super) fn hidden(&self, svg: &str) -> Result<Option<Hidden>> {
        let least = (LEAST * self.pixels as f64) as usize;
        let mut own = self
            .list
            .iter()
            .filter(|reach| reach.hidden.len() > least)
            .peekable();
        if own.peek().is_none() {
            return Ok(None);
        }
        let Some(others) = Self::of(svg, self.size)? else {
            return Ok(None);
        };
        let none = Reach::default();
        let mut sum = Hidden::default();
        for reach in own {
            let seen = mask(&reach.seen, self.pixels);
            let overlap = |other: &Reach| {
                let both = other.seen.iter().filter(|&&i| seen[i]).count();
                both as f64 / (reach.seen.len() + other.seen.len() - both).max(1) as f64
            };
            let alike = others.list.iter().filter(|other| overlap(other) >= SAME);
            let same = alike.max_by(|a, b| overlap(a).total_cmp(&overlap(b)));
            let same = same.unwrap_or(&none);
            let [has_found, is_seen] = [&same.hidden, &same.seen].map(|px| mask(px, self.pixels));
            let is_hidden = mask(&reach.hidden, self.pixels);
            // Where one is seen and the other hidden is an error of edges, which others tell.
            let apart = (0..self.pixels)
                .filter(|&i| !seen[i] && !is_seen[i])
                .filter(|&i| has_found[i] != is_hidden[i]);
            sum.px += reach.hidden.len();
            sum.apart_px += apart.count();
        }
        Ok(Some(sum))
    }
}

fn is_changed(a: &[f32; 4], b: &[f32; 4]) -> bool {
    let channels = a.iter().zip(b);
    channels.map(|(a, b)| (a - b).abs()).sum::<f32>() > CHANGED
}

fn mask(pixels: &[usize], count: usize) -> Vec<bool> {
    let mut mask = vec![false; count];
    pixels.iter().for_each(|&i| mask[i] = true);
    mask
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size::Scale(1.0);

    fn svg(body: &str) -> String {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32">{body}</svg>"#)
    }

    /// A card on a disc of which a half is hidden.
    const ARTIST: &str = r##"<circle cx="16" cy="16" r="8" fill="#d00"/><rect x="16" y="4" width="12" height="24" fill="#00d"/>"##;

    fn hidden(found: &str) -> Hidden {
        let artist = Reaches::of(&svg(ARTIST), SIZE).unwrap().unwrap();
        artist.hidden(&svg(found)).unwrap().unwrap()
    }

    #[test]
    fn the_hidden_half_of_a_disc_is_told() {
        let same = hidden(ARTIST);
        assert_eq!(same.apart_px, 0);
        assert!(same.px.abs_diff(100) < 12, "{same:?}");
        let cut = r##"<path d="M16 8A8 8 0 0 0 16 24Z" fill="#d00"/><rect x="16" y="4" width="12" height="24" fill="#00d"/>"##;
        let cut = hidden(cut);
        assert!(cut.apart_px.abs_diff(cut.px) < 4, "{cut:?}");
        let wide = r##"<path d="M16 8A8 8 0 0 0 16 24H26V8Z" fill="#d00"/><rect x="16" y="4" width="12" height="24" fill="#00d"/>"##;
        let wide = hidden(wide);
        assert!(wide.apart_px > 40 && wide.apart_px < 80, "{wide:?}");
    }

    #[test]
    fn what_hides_nothing_has_no_measure() {
        let apart = r##"<circle cx="8" cy="8" r="6" fill="#d00"/><circle cx="24" cy="24" r="6" fill="#00d"/>"##;
        let apart = Reaches::of(&svg(apart), SIZE).unwrap().unwrap();
        assert_eq!(apart.hidden(&svg(ARTIST)).unwrap(), None);
    }

    #[test]
    fn what_has_too_many_elements_is_not_judged() {
        let many = ARTIST.repeat(MOST / 2 + 1);
        assert!(Reaches::of(&svg(&many), SIZE).unwrap().is_none());
        let artist = Reaches::of(&svg(ARTIST), SIZE).unwrap().unwrap();
        assert_eq!(artist.hidden(&svg(&many)).unwrap(), None);
    }
}
