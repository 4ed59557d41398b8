//! Compares our front with each peer's at equal bytes after gzip.

use super::super::statistics::distinct;
use super::{ARTICLE, Comparison, Holds, OWN, ParetoEntry, front};

/// A peer's front on one picture, and how far our best drawing of no more bytes is from each of its drawings.
pub(super) struct AgainstPeer<'a> {
    /// Rising in bytes and dB.
    pub(super) front: Vec<&'a ParetoEntry>,
    /// dB that we gain; `None` where none of ours is as small.
    pub(super) gains_db: Vec<Option<f64>>,
}

impl<'a> AgainstPeer<'a> {
    /// One for each peer that has drawings in `here`, the drawings of one picture.
    pub(super) fn all(here: &[&'a ParetoEntry]) -> Vec<Self> {
        let families = here.iter().map(|e| e.family.as_str());
        let peers = families.filter(|family| ![OWN, ARTICLE].contains(family));
        let against = distinct(peers)
            .into_iter()
            .map(|peer| Self::new(here, peer));
        against
            .filter(|against| !against.front.is_empty())
            .collect()
    }

    fn new(here: &[&'a ParetoEntry], peer: &str) -> Self {
        let theirs = here.iter().copied().filter(|e| e.family == peer);
        let gzip = |e: &ParetoEntry| Some(e.gzip_bytes as f64);
        let front = front(theirs, gzip, ParetoEntry::psnr_db);
        let gain = |other: &&ParetoEntry| {
            let own = here.iter().filter(|e| e.family == OWN);
            let small = own.filter(|e| e.gzip_bytes <= other.gzip_bytes);
            let best = small.filter_map(|e| e.psnr_db()).reduce(f64::max)?;
            Some(best - other.psnr_db()?)
        };
        Self {
            gains_db: front.iter().map(gain).collect(),
            front,
        }
    }

    /// Whose drawings they are.
    pub(super) fn name(&self) -> &str {
        self.front.first().map_or("", |e| &e.family)
    }

    /// Where we are above, and by how much; and where not.
    pub(super) fn words(&self) -> String {
        let above = self.gains_db.iter().flatten().filter(|gain| **gain >= 0.0);
        let least = above.clone().copied().reduce(f64::min);
        let most = above.clone().copied().reduce(f64::max);
        let range = least.zip(most).map_or_else(String::new, |(least, most)| {
            format!(" by {least:.2} to {most:.2} dB")
        });
        let points = format!("{} of {}", above.count(), self.front.len());
        let below = self.front.iter().zip(&self.gains_db).filter_map(below);
        let below: Vec<String> = below.collect();
        let but = if below.is_empty() {
            String::new()
        } else {
            format!("; not at {}", below.join(", "))
        };
        format!("above it at {points} points of its front{range}{but}")
    }

    pub(super) fn comparison(&self) -> Comparison {
        let everywhere = self
            .gains_db
            .iter()
            .all(|gain| gain.is_some_and(|db| db >= 0.0));
        Comparison {
            picture: self
                .front
                .first()
                .map_or_else(String::new, |e| e.picture.clone()),
            claim: format!("as faithful as {} at equal bytes after gzip", self.name()),
            figure: self.words(),
            holds: if everywhere { Holds::Holds } else { Holds::Not },
        }
    }
}

/// Where and how far we are below a peer's drawing, if we are.
fn below((entry, gain): (&&ParetoEntry, &Option<f64>)) -> Option<String> {
    let kilobytes = entry.gzip_bytes as f64 / 1000.0;
    match gain {
        Some(db) if *db >= 0.0 => None,
        Some(db) => Some(format!("{kilobytes:.1} kB ({db:.2} dB)")),
        None => Some(format!("{kilobytes:.1} kB (none of ours is as small)")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{comparisons, drawing};
    use super::*;

    #[test]
    fn where_a_peer_is_better_is_said() {
        let own = |gzip, db| drawing(OWN, "draft 100 smoothstep seed 0", 1.0, gzip, db);
        let peer = |gzip, db| drawing("vtracer", "x", 0.1, gzip, db);
        let entries = [
            own(1000, 25.0),
            own(9000, 31.0),
            peer(500, 22.0),
            peer(1500, 26.0),
            peer(9500, 30.0),
        ];
        let comparison = &comparisons(&entries)[0];
        assert_eq!(comparison.holds, Holds::Not);
        for words in [
            "at 1 of 3",
            "by 1.00 to 1.00 dB",
            "0.5 kB (none",
            "1.5 kB (-1.00 dB)",
        ] {
            assert!(comparison.figure.contains(words), "{comparison:?}");
        }
    }
}
