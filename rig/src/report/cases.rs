//! Cases of a run: each a picture, who drew it, and what was made of it.

use serde::{Deserialize, Serialize};

use super::Damage;
use super::statistics::distinct;
use strokefit::report::SCHEMA;

/// Who makes our own drawings.
pub const OWN: &str = "strokefit";

/// All cases of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cases<Entry> {
    /// [`SCHEMA`].
    pub schema: u32,
    /// One per picture, and who drew that, in order.
    pub entries: Vec<Entry>,
}

/// A record of one case.
pub trait Case {
    /// Name of the picture.
    fn name(&self) -> &str;

    /// Who drew it: [`OWN`], or another program or way to draw.
    fn by(&self) -> &str;

    /// The longer side of the picture, px.
    fn side_px(&self) -> usize;

    /// Damage of the picture.
    fn damage(&self) -> Damage;

    /// Elements found, and those that were drawn.
    fn elements(&self) -> [usize; 2];

    /// Words for what was made.
    fn words(&self) -> String;

    /// Why nothing was made.
    fn failure(&self) -> Option<&str>;

    /// The picture in words: its size and damage.
    fn kind(&self) -> String {
        self.damage().of(self.side_px())
    }

    /// True for a drawing of ours.
    fn is_own(&self) -> bool {
        self.by() == OWN
    }

    /// The name of the SVG that was made: not that of the program where it is ours.
    fn svg_name(&self) -> String {
        let name = format!("{}-{}", self.name(), self.side_px());
        format!("{name}{}", self.suffix())
    }

    /// The end of the name of the SVG.
    fn suffix(&self) -> String {
        let by = (!self.is_own()).then(|| format!("-{}", self.by().replace(' ', "-")));
        format!("{}{}.svg", self.damage().suffix(), by.unwrap_or_default())
    }

    /// The line of standard output: whose picture of what, what was made of it, and the verdict.
    fn line(&self) -> String {
        let by = (!self.is_own()).then(|| format!(", {}", self.by()));
        let start = format!(
            "{} at {}{}",
            self.name(),
            self.kind(),
            by.unwrap_or_default()
        );
        match self.failure() {
            Some(why) => format!("{start}: {why}: FAIL"),
            None => format!("{start}: {}: pass", self.words()),
        }
    }
}

impl<Entry: Case> Cases<Entry> {
    /// The report of these cases.
    pub fn new(entries: Vec<Entry>) -> Self {
        Self {
            schema: SCHEMA,
            entries,
        }
    }

    /// Number of drawings that could not be made.
    pub fn failures(&self) -> usize {
        self.entries.len() - self.made().len()
    }

    /// The cases of which something was made.
    pub(super) fn made(&self) -> Vec<&Entry> {
        let entries = self.entries.iter();
        entries.filter(|entry| entry.failure().is_none()).collect()
    }
}

/// The cases of each kind and of each who drew them, in the order in which they come first.
pub(super) fn grouped<'a, Entry>(
    made: &[&'a Entry],
    kind: impl Fn(&Entry) -> String,
    by: impl Fn(&Entry) -> String,
) -> Vec<(String, String, Vec<&'a Entry>)> {
    let mut groups = Vec::new();
    for kind_name in distinct(made.iter().map(|entry| kind(entry))) {
        for by_name in distinct(made.iter().map(|entry| by(entry))) {
            let here = made.iter().copied();
            let here = here.filter(|entry| kind(entry) == kind_name && by(entry) == by_name);
            let here: Vec<&Entry> = here.collect();
            if !here.is_empty() {
                groups.push((kind_name.clone(), by_name, here));
            }
        }
    }
    groups
}
