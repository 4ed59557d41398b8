//! The objects of a PDF, and where they lie in the file.

use crate::report::deflated;

/// A file that grows object by object.
pub(super) struct File {
    bytes: Vec<u8>,
    /// Where each object begins; 0 where it is not written yet.
    offsets: Vec<usize>,
}

impl File {
    pub(super) fn new() -> Self {
        Self {
            // Bytes beyond ASCII tell programs that the file is binary.
            bytes: b"%PDF-1.5\n%\xE2\xE3\xCF\xD3\n".to_vec(),
            offsets: Vec::new(),
        }
    }

    /// The number of an object that is written later.
    pub(super) fn reserve(&mut self) -> usize {
        self.offsets.push(0);
        self.offsets.len()
    }

    /// Writes an object, and returns its number.
    pub(super) fn add(&mut self, object: &str) -> usize {
        let id = self.reserve();
        self.set(id, object);
        id
    }

    /// Writes an object whose number is reserved.
    pub(super) fn set(&mut self, id: usize, object: &str) {
        self.write(id, object.as_bytes());
    }

    /// Writes a stream with these `entries` of its dictionary, compressed, and returns its number.
    pub(super) fn stream(&mut self, entries: &str, data: &[u8]) -> usize {
        let data = deflated(data);
        let head = format!(
            "<</Length {}/Filter/FlateDecode{entries}>>stream\n",
            data.len()
        );
        let id = self.reserve();
        self.write(id, &[head.as_bytes(), &data, b"\nendstream"].concat());
        id
    }

    fn write(&mut self, id: usize, object: &[u8]) {
        if let Some(offset) = self.offsets.get_mut(id - 1) {
            *offset = self.bytes.len();
        }
        self.bytes.extend(format!("{id} 0 obj\n").bytes());
        self.bytes.extend(object);
        self.bytes.extend(b"\nendobj\n");
    }

    /// The bytes of the file, whose root is the object `catalog`.
    pub(super) fn finish(mut self, catalog: usize) -> Vec<u8> {
        let (start, count) = (self.bytes.len(), self.offsets.len() + 1);
        let mut table = format!("xref\n0 {count}\n0000000000 65535 f \n");
        for offset in &self.offsets {
            table += &format!("{offset:010} 00000 n \n");
        }
        table +=
            &format!("trailer<</Size {count}/Root {catalog} 0 R>>\nstartxref\n{start}\n%%EOF\n");
        self.bytes.extend(table.bytes());
        self.bytes
    }
}
