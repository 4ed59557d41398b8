//! The colours of a drawing, which layers and cut-outs go by.

/// Each of these colours once, in the order in which they first come.
pub(super) fn distinct(colors: impl IntoIterator<Item = [u8; 3]>) -> Vec<[u8; 3]> {
    let mut found = Vec::new();
    for color in colors {
        if !found.contains(&color) {
            found.push(color);
        }
    }
    found
}
