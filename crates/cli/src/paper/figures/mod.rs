//! The figures of the summary, as SVG text.

mod agreement;
mod onset;
mod orders;
mod region;

use crate::failure::{Failure, NO_ANSWER};
use lindstedt_paper::Trust;
use lindstedt_paper::page::Figure;
use plotters::prelude::RGBColor;

/// Letters stay readable when a page is narrow: the pictures are small and are scaled up.
const SIZE: (u32, u32) = (640, 420);

/// Colours that differ in brightness and for colour-blind readers (Okabe and Ito).
const GREEN: RGBColor = RGBColor(0, 158, 115);
const VERMILION: RGBColor = RGBColor(213, 94, 0);
const SKY: RGBColor = RGBColor(86, 180, 233);
const BLUE: RGBColor = RGBColor(0, 114, 178);
const PURPLE: RGBColor = RGBColor(204, 121, 167);
const ORANGE: RGBColor = RGBColor(230, 159, 0);
const GREY: RGBColor = RGBColor(150, 150, 150);
const PALE: RGBColor = RGBColor(232, 232, 232);

/// All figures whose measurements are finished.
pub fn draw(trust: &Trust) -> Result<Vec<Figure>, Failure> {
    let mut list = Vec::new();
    if let Some(region) = &trust.region {
        list.push(agreement::draw(region)?);
        list.push(region::draw(region)?);
    }
    if let Some(onset) = &trust.onset {
        list.push(onset::draw(onset)?);
    }
    if !trust.truncations.is_empty() {
        list.push(orders::draw(&trust.truncations)?);
    }
    Ok(list)
}

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    }
}
