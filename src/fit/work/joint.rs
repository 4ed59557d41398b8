//! All strokes together: polish, and settling against the file.

use super::{Task, Work, budget};
use crate::error::Result;
use crate::fit::palette::{self, Colors, Palette};
use crate::fit::polish::{Polish, Terms};
use crate::fit::recipe::Recipe;
use crate::fit::{Stop, pens, settle};
use crate::metrics::psnr_db;
use crate::svg::Form;

impl Work<'_> {
    /// Begins to fit all strokes jointly.
    pub(in crate::fit) fn polish(&mut self, steps: usize) {
        if self.is_stopped() || !self.control.allows_polish() {
            return;
        }
        self.drawing.thaw();
        // A fidelity is met by as few strokes as may be: their number is corrected afterwards.
        let limit = match self.config.budget.psnr_db {
            Some(_) => self.drawing.len(),
            None => self.terms.limit,
        };
        self.control.enter(self.standing.records.len());
        self.begin_polish(limit, steps);
    }

    pub(super) fn begin_polish(&mut self, limit: usize, steps: usize) {
        self.control.polish();
        let until = self.given().0;
        let (drawing, control) = (&self.drawing, &self.control);
        let polish = Polish::new(drawing, &self.recipe, limit, steps, until, control);
        self.then(Task::Polishing(polish));
    }

    /// The shares of a limited time for descent after which polish and the fit to a palette have to be over; what
    /// is left after that is for pens. Each has its part by its iterations.
    fn given(&self) -> (f32, f32) {
        let polish = 1.0;
        let colors = match self.config.colors {
            Colors::Free => 0.0,
            _ => palette::ROUNDS.iterations,
        };
        let pens = match self.config.file.form {
            Form::Smallest => pens::ROUNDS.iterations,
            _ => 0.0,
        };
        let all = polish + colors + pens;
        ((polish / all) as f32, ((polish + colors) / all) as f32)
    }

    /// An iteration of a joint fit, unless it is at its end.
    pub(in crate::fit) fn polishing(&mut self, mut polish: Polish) -> Result<()> {
        self.rehearse()?;
        let (drawing, control) = (&mut self.drawing, &mut self.control);
        let (anneal, price) = (self.anneal, self.terms.price);
        if control.stopped().is_none() && polish.step(drawing, &self.recipe, anneal, price, control)
        {
            self.then(Task::Polishing(polish));
        }
        Ok(())
    }

    /// Settles the drawing against its file, where anything depends on what that looks like.
    pub(in crate::fit) fn settle(&mut self) -> Result<()> {
        self.drawing.thaw();
        self.drawing.refine(0.0);
        let recipe = self.restricted();
        if budget::needs_file(&self.config.budget, &recipe) {
            let (drawing, control) = (&mut self.drawing, &mut self.control);
            let written = settle::run(drawing, self.page, &recipe, control)?;
            self.standing.corrections.last_db = psnr_db(written.mse);
            let (budget, best) = (&self.config.budget, self.best.as_ref());
            if best.is_none_or(|best| budget::is_better(budget, &written, best)) {
                self.set_best(written);
            }
        }
        // What was settled in haste is nothing to go on from.
        self.is_final |= self.control.stopped() == Some(Stop::Observer);
        Ok(())
    }

    /// Brings the drawing to the colours and pens that it may have, and returns the recipe that leaves them as they are.
    fn restricted(&mut self) -> Recipe {
        let mut recipe = self.recipe;
        if let Some(palette) = self.palette() {
            self.color(palette);
            recipe.polish_rates = palette::without_color(recipe.polish_rates);
        }
        if self.config.file.form == Form::Smallest {
            let (anneal, control) = (self.anneal, &mut self.control);
            let keep_colors = self.config.colors != Colors::Free;
            pens::run(&mut self.drawing, keep_colors, &recipe, anneal, control);
            recipe.polish_rates = pens::without_pen(recipe.polish_rates);
        }
        recipe
    }

    /// The palette of the drawing, if it has to have one.
    fn palette(&mut self) -> Option<Palette> {
        let colors = &self.config.colors;
        if *colors == Colors::Free {
            return None;
        }
        let strokes = self.drawing.len();
        let mut wishes = self.drawing.wishes(0.0);
        if !self.page.has_ground {
            // No background is drawn.
            wishes.truncate(strokes);
        }
        let is_given = self.page.has_ground && self.drawing.background_fixed;
        let ground = self.drawing.background().filter(|_| is_given);
        Palette::new(colors, &wishes, ground)
    }

    /// Gives every stroke a colour of `palette`.
    fn color(&mut self, mut palette: Palette) {
        let until = self.given().1;
        let (drawing, anneal) = (&mut self.drawing, self.anneal);
        let terms = Terms {
            limit: drawing.len(),
            ..self.terms
        };
        let (recipe, control) = (&self.recipe, &mut self.control);
        control.give_until(until);
        palette::run(drawing, &mut palette, recipe, anneal, terms, control);
        control.give_until(1.0);
    }
}
