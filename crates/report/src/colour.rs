//! Colours of pictures on a light page, and what each of them becomes on a dark one.

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Colour {
    light: &'static str,
    opacity: f64,
}

/// A colour on white, and the one that takes its place on a dark page.
type Pair = (&'static str, &'static str);

const PAPER: Pair = ("#FFFFFF", "#15171A");
const INK: Pair = ("#222222", "#E6E6E6");
const AXIS: Pair = ("#555555", "#9AA2AB");
const GRID: Pair = ("#E2E2E2", "#33383E");
/// Of heat maps: the letters can be read on all its shades, on both pages.
const SHADE: Pair = ("#5AB4E8", "#14608F");
/// The palette by Okabe and Ito, Color Universal Design, 2008, and lighter tones of the same hues; the yellow, which is
/// the faintest on white, comes last.
const PALETTE: [Pair; 8] = [
    ("#0072B2", "#4AA3E0"),
    ("#D55E00", "#F08A3C"),
    ("#009E73", "#2FCF9F"),
    ("#CC79A7", "#E39AC4"),
    ("#E69F00", "#F2B632"),
    ("#56B4E9", "#9AD4F7"),
    ("#000000", "#FFFFFF"),
    ("#F0E442", "#F0E443"),
];

impl Colour {
    pub(crate) const PAPER: Self = Self::of(PAPER);
    pub(crate) const INK: Self = Self::of(INK);
    pub(crate) const AXIS: Self = Self::of(AXIS);
    pub(crate) const GRID: Self = Self::of(GRID);
    pub(crate) const SHADE: Self = Self::of(SHADE);

    const fn of(pair: Pair) -> Self {
        Self {
            light: pair.0,
            opacity: 1.0,
        }
    }

    /// Colour of the palette.
    pub(crate) fn palette(index: usize) -> Self {
        Self::of(PALETTE[index % PALETTE.len()])
    }

    pub(crate) fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    pub(crate) fn is_invisible(self) -> bool {
        self.opacity == 0.0
    }

    /// Opacity and colour as attributes of SVG, the colour under the name `paint`.
    pub(crate) fn attributes(self, paint: &str) -> String {
        let (light, opacity) = (self.light, self.opacity);
        format!("opacity=\"{opacity}\" {paint}=\"{light}\"")
    }
}

/// Rules of a style sheet by which pictures below `scope` have their dark colours where the reader's page is dark. They
/// stand above the colours that the elements carry, so that a program without style sheets shows the light ones.
pub(crate) fn dark_rules(scope: &str) -> String {
    let pairs = [PAPER, INK, AXIS, GRID, SHADE].into_iter().chain(PALETTE);
    let rules = pairs.map(|(light, dark)| {
        let rule = |paint: &str| format!("{scope}[{paint}=\"{light}\"]{{{paint}:{dark}}}");
        rule("fill") + &rule("stroke")
    });
    format!(
        "@media screen and (prefers-color-scheme: dark){{{}}}",
        rules.collect::<String>()
    )
}

/// The style of a picture that stands alone.
pub(crate) fn style_element() -> String {
    format!("<style>{}</style>\n", dark_rules(""))
}
