//! Rows of cells under a head, as CSV or Markdown.

use std::fmt::Display;

/// A column of a table: its head, and its cell of a record.
pub type Column<R> = (&'static str, fn(&R) -> String);

/// A table of texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of the columns `head`.
    pub fn new<S: AsRef<str>>(head: &[S]) -> Self {
        Self {
            head: head.iter().map(|cell| cell.as_ref().to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// A row for each of `rows`, by columns of a head and the cell of a row.
    pub fn of<'r, R: 'r>(columns: &[Column<R>], rows: impl IntoIterator<Item = &'r R>) -> Self {
        let heads: Vec<&str> = columns.iter().map(|column| column.0).collect();
        let mut table = Self::new(&heads);
        for row in rows {
            table.row(columns.iter().map(|column| column.1(row)));
        }
        table
    }

    /// This table without columns whose cells are all empty.
    #[must_use]
    pub fn without_empty_columns(mut self) -> Self {
        for i in (0..self.head.len()).rev() {
            if self.rows.iter().all(|row| row[i].is_empty()) {
                self.head.remove(i);
                self.rows.iter_mut().for_each(|row| drop(row.remove(i)));
            }
        }
        self
    }

    /// Appends a row, of as many cells as the head has.
    pub fn row<D: Display>(&mut self, cells: impl IntoIterator<Item = D>) {
        let cells: Vec<String> = cells.into_iter().map(|cell| cell.to_string()).collect();
        debug_assert_eq!(cells.len(), self.head.len());
        self.rows.push(cells);
    }

    /// As comma-separated values. Cells with a comma, a quote or a line break are quoted.
    pub fn csv(&self) -> String {
        let line = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| quoted(cell)).collect();
            cells.join(",") + "\n"
        };
        self.lines().map(line).collect()
    }

    /// As a Markdown table.
    pub fn markdown(&self) -> String {
        let line = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut lines = self.lines().map(line);
        let head = lines.next().unwrap_or_default();
        let rule = format!("|{}\n", " --- |".repeat(self.head.len()));
        head + &rule + &lines.collect::<String>()
    }

    fn lines(&self) -> impl Iterator<Item = &Vec<String>> {
        std::iter::once(&self.head).chain(&self.rows)
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&["a", "b"]);
        table.row(["1,2", "say \"x\""]);
        table.row(["1.5", "<|>"]);
        table
    }

    #[test]
    fn cells_that_need_quotes_get_them() {
        assert_eq!(table().csv(), "a,b\n\"1,2\",\"say \"\"x\"\"\"\n1.5,<|>\n");
    }

    #[test]
    fn markdown_keeps_bars_within_their_cell() {
        let expected = "| a | b |\n| --- | --- |\n| 1,2 | say \"x\" |\n| 1.5 | <\\|> |\n";
        assert_eq!(table().markdown(), expected);
    }
}
