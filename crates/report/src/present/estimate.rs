//! An expansion in estimated numbers.

use super::{Pen, Present, condition_text};
use crate::{Block, Document, Formula, Table};
use lindstedt::Answer;
use lindstedt::numeric::Estimate;

impl Present for Answer<Estimate> {
    fn page(&self, _: Pen) -> Document {
        let result = &self.value;
        let equation = Block::Code(self.header.equation.clone());
        let mut page = Document::titled(self.header.problem.as_str()).with(equation);
        page = page.words(format!("Normalisation: {}.", condition_text(result.condition)));
        page = page.words(format!(
            "Estimated numbers ({} nodes, {} bits): the error is four times the difference of two grids.",
            result.nodes, result.bits
        ));
        for (series, numbers) in result.series.iter().zip(&result.numbers) {
            let name = series.quantity.name().replace('_', " ");
            page = page.words(format!("{name} in powers of {}:", result.parameter));
            for (n, number) in numbers.iter().enumerate() {
                page = page.formula(match number {
                    None => Formula::new(
                        format!("{n}: not one digit"),
                        format!("{n}:\\quad \\text{{not one digit}}"),
                    ),
                    Some(number) => {
                        let error = number.error.as_deref().unwrap_or("0");
                        Formula::new(
                            format!("{n}: {}  (+- {error})", number.decimal),
                            format!("{n}:\\quad {} \\pm {error}", number.decimal),
                        )
                    }
                });
            }
        }
        page
    }

    fn table(&self) -> Option<Table> {
        let mut table = Table::new(["series", "order", "coefficient", "error"]);
        for (series, numbers) in self.value.series.iter().zip(&self.value.numbers) {
            for (n, number) in numbers.iter().enumerate() {
                let (decimal, error) = number.as_ref().map_or_else(Default::default, |number| {
                    (number.decimal.clone(), number.error.clone().unwrap_or_default())
                });
                table = table.row([series.quantity.to_string(), n.to_string(), decimal, error]);
            }
        }
        Some(table)
    }
}
