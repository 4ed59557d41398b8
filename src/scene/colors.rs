//! The colours of a drawing, which layers, cut-outs and style sheets go by.

use std::collections::BTreeSet;

/// Each of these colours once, in the order in which they first come.
pub(crate) fn distinct_colors(colors: impl IntoIterator<Item = [u8; 3]>) -> Vec<[u8; 3]> {
    let mut seen = BTreeSet::new();
    let colors = colors.into_iter();
    colors.filter(|color| seen.insert(*color)).collect()
}
