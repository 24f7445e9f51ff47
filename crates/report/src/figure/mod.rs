//! Figures: layers in one frame, drawn as SVG.
//!
//! What is shown is data ([`Figure`]); how it is drawn stands once, in this folder. Coordinates
//! are drawn ten times finer than they are shown, because the drawing library rounds them to whole
//! units. Colours are those of Okabe and Ito, which differ in brightness and for colour-blind readers.

mod draw;
mod scale;

use crate::Table;
pub use scale::Scale;

/// A colour as red, green, blue.
pub type Colour = (u8, u8, u8);

/// Colours that differ in brightness and for colour-blind readers (Okabe and Ito, 2008).
pub mod colours {
    use super::Colour;
    /// Black.
    pub const BLACK: Colour = (0, 0, 0);
    /// Grey, for what is beside the point.
    pub const GREY: Colour = (150, 150, 150);
    /// Blue.
    pub const BLUE: Colour = (0, 114, 178);
    /// Sky blue.
    pub const SKY: Colour = (86, 180, 233);
    /// Green.
    pub const GREEN: Colour = (0, 158, 115);
    /// Orange.
    pub const ORANGE: Colour = (230, 159, 0);
    /// Vermilion.
    pub const VERMILION: Colour = (213, 94, 0);
    /// Purple.
    pub const PURPLE: Colour = (204, 121, 167);
    /// The plane of a prediction and the truth: both stable, both unstable, predicted stable but unstable, predicted
    /// unstable but stable. Their lightness alone, 77, 226, 119, 183 of 255, tells them apart in print without colours.
    pub const VERDICTS: [Colour; 4] = [(0, 114, 84), (226, 226, 226), VERMILION, (130, 200, 240)];
    /// One colour after the other, for curves of a family.
    pub const CYCLE: [Colour; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK];
}

/// How the points of a layer are marked; widths and radii in shown units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mark {
    /// A line through the points, broken where a coordinate is not finite.
    Line(u32),
    /// The same, dashed.
    Dashed(u32),
    /// Filled discs.
    Disc(u32),
    /// Circles.
    Ring(u32),
    /// Triangles.
    Triangle(u32),
    /// Crosses.
    Cross(u32),
    /// Filled squares.
    Square(u32),
}

/// Points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its words in the legend; layers of the same words share one entry, none without words.
    pub name: Option<String>,
    /// The points, in the order in which a line goes through them.
    pub points: Vec<(f64, f64)>,
    /// The mark.
    pub mark: Mark,
    /// The colour.
    pub colour: Colour,
    /// A word beside each point; empty, or one per point.
    pub labels: Vec<String>,
}

/// A raster of coloured cells behind the layers: one cell per point of a grid over two parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// First and last abscissa, number of columns.
    pub columns: (f64, f64, usize),
    /// First and last ordinate, number of rows.
    pub rows: (f64, f64, usize),
    /// The colours, row by row; nothing where a cell is left open.
    pub cells: Vec<Option<Colour>>,
    /// The legend: words for colours.
    pub legend: Vec<(String, Option<Colour>)>,
}

impl Raster {
    /// The cells of a grid of so many columns and rows; of one that is finer than what is drawn, every so many.
    pub(crate) fn cells<C>(
        (width, height): (usize, usize),
        mut colour: impl FnMut(usize) -> Option<C>,
    ) -> Vec<Option<C>>
    where
        C: Copy,
    {
        let mut cells = vec![None; width * height];
        for row in (0..height).step_by(draw::stride(height)) {
            for column in (0..width).step_by(draw::stride(width)) {
                let index = row * width + column;
                cells[index] = colour(index);
            }
        }
        cells
    }
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its words, with the unit.
    pub label: String,
    /// Its scale.
    pub scale: Scale,
    /// The words at 1, 2, 3, ...; numbers at the ticks where empty.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, names: Vec::new() }
    }

    /// A logarithmic axis.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label) }
    }

    /// Places 1, 2, 3, ... with their names.
    pub fn named<N: Into<String>>(
        label: impl Into<String>,
        names: impl IntoIterator<Item = N>,
    ) -> Self {
        Self { names: names.into_iter().map(Into::into).collect(), ..Self::linear(label) }
    }
}

/// One frame with its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The title.
    pub title: String,
    /// A line below the frame; may be empty.
    pub footer: String,
    /// Abscissa and ordinate.
    pub axes: [Axis; 2],
    /// Cells behind the layers.
    pub raster: Option<Raster>,
    /// The layers, the first at the back.
    pub layers: Vec<Layer>,
    /// Width and height in shown units: the smaller, the larger the letters on a page.
    pub size: (u32, u32),
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// No point has finite coordinates.
    #[error("nothing to draw: no point with finite coordinates")]
    Empty,
    /// The drawing library failed.
    #[error("the figure cannot be drawn: {0}")]
    Drawing(String),
}

impl Figure {
    /// An empty frame.
    pub fn new(title: impl Into<String>, across: Axis, up: Axis) -> Self {
        Self {
            title: title.into(),
            footer: String::new(),
            axes: [across, up],
            raster: None,
            layers: Vec::new(),
            size: (960, 640),
        }
    }

    /// The figure with one more layer in front.
    #[must_use]
    pub fn layer(
        mut self,
        name: Option<&str>,
        mark: Mark,
        colour: Colour,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let points = points.into_iter().collect();
        let name = name.map(str::to_owned);
        self.layers.push(Layer { name, points, mark, colour, labels: Vec::new() });
        self
    }

    /// The figure as SVG text.
    ///
    /// # Errors
    /// [`FigureError::Empty`] where nothing is finite.
    ///
    /// ```
    /// use lindstedt_report::figure::{Axis, Figure, Mark, colours};
    /// let figure = Figure::new("backbone", Axis::linear("frequency"), Axis::linear("amplitude"))
    ///     .layer(Some("order 2"), Mark::Line(2), colours::BLUE, [(1.0, 0.0), (1.1, 0.5)]);
    /// assert!(figure.svg()?.starts_with("<svg"));
    /// # Ok::<(), lindstedt_report::FigureError>(())
    /// ```
    pub fn svg(&self) -> Result<String, FigureError> {
        draw::svg(&[self])
    }

    /// Figures side by side as one SVG text; the legend is that of the first.
    ///
    /// # Errors
    /// As [`Figure::svg`].
    pub fn panels(figures: &[&Self]) -> Result<String, FigureError> {
        draw::svg(figures)
    }

    /// The points as a table: name of the layer, abscissa, ordinate.
    #[must_use]
    pub fn table(&self) -> Table {
        let [across, up] = &self.axes;
        let head = Table::new(["layer", &across.label, &up.label]);
        let rows = self.layers.iter().flat_map(|layer| {
            let name = layer.name.clone().unwrap_or_default();
            layer.points.iter().map(move |(x, y)| [name.clone(), x.to_string(), y.to_string()])
        });
        rows.fold(head, Table::row)
    }
}
