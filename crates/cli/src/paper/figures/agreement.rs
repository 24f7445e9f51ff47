//! How often each rule has the true verdict: bars.

use super::{Figure, GREEN, GREY, PALE, SIZE, VERMILION, failed};
use crate::failure::Failure;
use crate::simulate::plot::{Drawn, FINE, stroke};
use lindstedt_paper::trust::{Rate, Region};
use plotters::prelude::*;

const HEIGHT: u32 = 250;
/// Where the bars begin.
const LEFT: i32 = 150;

pub fn draw(region: &Region) -> Result<Figure, Failure> {
    let rates = &region.sample.rates;
    let mut svg = String::new();
    paint(rates, &mut svg).map_err(|error| failed(&error))?;
    // A rule that says something at a part of the points is judged there.
    let parts: Vec<String> = (rates.iter().filter(|rate| rate.compared < region.sample.points))
        .map(|rate| format!(" {}: of the {} points where it exists.", rate.rule, rate.compared))
        .collect();
    let large = format!("width=\"{}\" height=\"{}\"", SIZE.0 * FINE, HEIGHT * FINE);
    let small = format!("width=\"{}\" height=\"{HEIGHT}\"", SIZE.0);
    Ok(Figure {
        name: "agreement",
        section: 2,
        caption: format!(
            "Share of {} points (8 orbits, gains $|A|$, $|B| <= 0.3$) at which a rule has the verdict of \
             the delayed system; {} of them are truly stable.{}",
            region.sample.points,
            region.sample.stable,
            parts.concat()
        )
        .into(),
        svg: svg.replacen(&large, &small, 1),
    })
}

fn paint(rates: &[Rate], svg: &mut String) -> Drawn {
    let fine = FINE as i32;
    let root = SVGBackend::with_string(svg, (SIZE.0 * FINE, HEIGHT * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let font = |size: u32| ("sans-serif", size * FINE).into_text_style(&root);
    let step = (HEIGHT as i32 - 40) / rates.len().max(1) as i32;
    let width = f64::from(SIZE.0 as i32 - LEFT - 80);
    let at = |share: f64| (LEFT + (width * share) as i32) * fine;
    for (share, word) in [(0.0, "0"), (0.5, "50 %"), (1.0, "100 %")] {
        let ends = vec![(at(share), 8 * fine), (at(share), (HEIGHT as i32 - 30) * fine)];
        root.draw(&PathElement::new(ends, stroke(PALE, 1)))?;
        let style = font(13).color(&RGBColor(90, 90, 90));
        let shift = 4 * word.len() as i32 * fine;
        root.draw_text(word, &style, (at(share) - shift, (HEIGHT as i32 - 24) * fine))?;
    }
    for (n, rate) in rates.iter().enumerate() {
        let top = (12 + step * n as i32) * fine;
        let colour = match rate.rule {
            "G" => GREEN,
            rule if rule.starts_with("(17)") => VERMILION,
            _ => GREY,
        };
        let bottom = top + (step - 10) * fine;
        root.draw(&Rectangle::new([(at(0.0), top), (at(rate.rate), bottom)], colour.filled()))?;
        let middle = top + (step / 2 - 12) * fine;
        root.draw_text(rate.rule, &font(15), (14 * fine, middle))?;
        let shown = format!("{:.1} %", 100.0 * rate.rate);
        root.draw_text(&shown, &font(14), (at(rate.rate) + 8 * fine, middle))?;
    }
    root.present()?;
    Ok(())
}
