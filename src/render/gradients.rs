//! Results of the backward passes: derivatives by the numbers of strokes, and by the vertices of their polylines.

/// Derivatives of a loss by everything that was drawn.
#[derive(Debug, Clone, Default)]
pub struct Gradients {
    /// The loss itself.
    pub loss: f64,
    /// `∂L/∂` each of [`Strokes::numbers`](super::Strokes::numbers), in their order.
    pub strokes: Vec<f32>,
    /// `∂L/∂backdrop`, summed over the pixels.
    pub backdrop: [f32; 3],
    /// Growth of the squared error (summed over pixels and channels) if the stroke is
    /// left out, exactly; filled by [`Renderer::backward_with_contributions`](super::Renderer::backward_with_contributions) alone.
    pub contribution: Vec<f32>,
    /// Blocks of 16 px that were visited: the work done.
    pub blocks: u64,
}

/// Dependence of the loss on the vertices of polylines that are as fine as their points could become.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// The first vertex of each stroke, and behind the last stroke the number of all vertices.
    pub firsts: Vec<u32>,
    /// The vertices, px.
    pub vertices: Vec<[f32; 2]>,
    /// `∂L/∂vertex`.
    pub slopes: Vec<[f32; 2]>,
    /// An upper bound of the second derivative of the squared error (summed over pixels and channels) by a shift of the
    /// vertex, after Gauss and Newton. The sum over several vertices is one of a shift of all of them.
    pub stiffness: Vec<f32>,
}

impl Gradients {
    /// Adds the derivatives of another loss by the same strokes.
    pub(crate) fn add(&mut self, other: &Self) {
        self.loss += other.loss;
        self.blocks += other.blocks;
        add(&mut self.backdrop, &other.backdrop);
        add(&mut self.contribution, &other.contribution);
        add(&mut self.strokes, &other.strokes);
    }

    /// Multiplies the loss, its derivatives and the contribution by `factor`.
    pub(crate) fn scale(&mut self, factor: f32) {
        self.loss *= f64::from(factor);
        let values = self.strokes.iter_mut();
        for value in values
            .chain(&mut self.backdrop)
            .chain(&mut self.contribution)
        {
            *value *= factor;
        }
    }
}

impl Survey {
    /// Adds the derivatives of another loss by the same strokes.
    pub(crate) fn add(&mut self, other: &Self) {
        add(self.slopes.as_flattened_mut(), other.slopes.as_flattened());
        add(&mut self.stiffness, &other.stiffness);
    }

    /// Multiplies all derivatives by `factor`.
    pub(crate) fn scale(&mut self, factor: f32) {
        let slopes = self.slopes.as_flattened_mut().iter_mut();
        slopes.chain(&mut self.stiffness).for_each(|v| *v *= factor);
    }
}

pub(super) fn add(sums: &mut [f32], parts: &[f32]) {
    for (sum, part) in sums.iter_mut().zip(parts) {
        *sum += part;
    }
}
