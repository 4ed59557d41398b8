//! Arguments of a program: one by one, or as the words of a line.

/// A word that begins with `@` is the path of a file that is committed: `@samples/bicycle.png`.
pub(crate) trait Words {
    fn words(&self) -> Vec<String>;
}

fn word(word: &str) -> String {
    let committed = word.strip_prefix('@');
    committed.map_or(word.into(), |path| {
        format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
    })
}

impl Words for str {
    fn words(&self) -> Vec<String> {
        self.split_whitespace().map(word).collect()
    }
}

impl Words for String {
    fn words(&self) -> Vec<String> {
        self.as_str().words()
    }
}

impl<S: AsRef<str>> Words for [S] {
    fn words(&self) -> Vec<String> {
        self.iter().map(|s| word(s.as_ref())).collect()
    }
}

impl<S: AsRef<str>, const N: usize> Words for [S; N] {
    fn words(&self) -> Vec<String> {
        self[..].words()
    }
}

impl<S: AsRef<str>> Words for Vec<S> {
    fn words(&self) -> Vec<String> {
        self[..].words()
    }
}

impl<W: Words + ?Sized> Words for &W {
    fn words(&self) -> Vec<String> {
        (**self).words()
    }
}
