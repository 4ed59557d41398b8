//! The rigs as their users meet them, and what holds for their source.
#![allow(clippy::unwrap_used, clippy::panic)]

mod support {
    pub(crate) mod built;
    #[path = "../../../../tests/all/support/output.rs"]
    pub(crate) mod output;
    #[path = "../../../../tests/all/support/picture.rs"]
    pub(crate) mod picture;
    #[path = "../../../../tests/all/support/place.rs"]
    pub(crate) mod place;
    #[path = "../../../../tests/all/support/program.rs"]
    pub(crate) mod program;
    #[path = "../../../../tests/all/support/words.rs"]
    pub(crate) mod words;
}

mod bench;
#[cfg(unix)]
mod compare;
#[path = "../../../tests/all/dependencies.rs"]
mod dependencies;
mod golden;
mod hard;
mod help;
#[path = "../../../tests/all/imports.rs"]
mod imports;
mod kinks;
mod lab_cli;
mod lab_tables;
mod robust;
