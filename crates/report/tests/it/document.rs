//! Documents: self-contained, escaped, with a table of contents.

use haptical_report::{
    Block, Cell, Column, Document, Figure, Link, Mark, Section, Series, Table, Tone,
};

fn svg() -> String {
    let mut figure = Figure::new("Error on <joint> = 1", "x [m]", "y [m]");
    figure.series.push(Series::new(
        "a & b",
        Mark::Line,
        0,
        vec![(0.0, 0.0), (1.0, 1.0)],
    ));
    figure.to_svg(400, 300).unwrap()
}

fn page(blocks: Vec<Block>) -> String {
    let second = Section::new("Second <part>", vec![Block::Paragraph("end".to_owned())]);
    Document::new(
        "A <title>",
        "Lead & more",
        vec![Section::new("First", blocks), second],
    )
    .to_html()
}

fn drawing(svg: &str) -> Block {
    Block::Svg {
        caption: "A <caption>".to_owned(),
        svg: svg.to_owned(),
    }
}

#[test]
fn every_block_appears_escaped() {
    let mut table = Table::new("T <1>", vec![Column::new("c", "<m>")]);
    table.push(vec![Cell::from("<cell>")]).unwrap();
    let html = page(vec![
        Block::Paragraph("<p1>".to_owned()),
        Block::Table(table),
        drawing(&svg()),
        Block::List(vec!["<item>".to_owned()]),
        Block::Verdict {
            good: true,
            text: "<yes>".to_owned(),
        },
        Block::Verdict {
            good: false,
            text: "<no>".to_owned(),
        },
        Block::Notice {
            tone: Tone::Neutral,
            label: "<label>".to_owned(),
            text: "<notice>".to_owned(),
        },
        Block::Folded {
            summary: "<fold>".to_owned(),
            blocks: vec![Block::Paragraph("<folded>".to_owned())],
        },
    ]);
    for text in [
        "A <title>",
        "Second <part>",
        "<p1>",
        "T <1>",
        "<m>",
        "<cell>",
        "A <caption>",
        "<item>",
        "<yes>",
        "<no>",
        "<label>",
        "<notice>",
        "<fold>",
        "<folded>",
    ] {
        let escaped = text.replace('<', "&lt;").replace('>', "&gt;");
        assert!(html.contains(&escaped) && !html.contains(text), "{text}");
    }
    assert!(html.contains("Lead &amp; more") && html.contains("a &amp; b"));
    assert!(html.contains("verdict good") && html.contains("verdict bad"));
    assert!(html.contains("<polyline"), "the figure is inside");
}

#[test]
fn the_page_refers_to_nothing_outside_itself() {
    let html = page(vec![drawing(&svg())]);
    let outside: Vec<&str> = html
        .split("http")
        .skip(1)
        .filter(|rest| !rest.starts_with("://www.w3.org/2000/svg\"") && !rest.starts_with("-equiv"))
        .collect();
    assert!(outside.is_empty(), "{outside:?}");
    for word in ["<script", "<link", " src=", "@import", "url("] {
        assert!(!html.contains(word), "{word}");
    }
    assert!(!html.contains("script-src"), "no script is allowed");
    assert!(html.contains("name=\"viewport\"") && html.contains("@media print"));
    assert!(html.contains("prefers-color-scheme: dark") && html.contains("overflow-x: auto"));
}

#[test]
fn contents_link_to_the_sections() {
    let html = page(vec![]);
    for index in 1..=2 {
        assert!(html.contains(&format!("href=\"#section-{index}\"")));
        assert!(html.contains(&format!("id=\"section-{index}\"")));
    }
    let single = Document::new("T", "", vec![Section::new("Only", vec![])]).to_html();
    assert!(!single.contains("<nav") && !single.contains("class=\"lead\""));
}

#[test]
fn a_figure_that_is_more_than_a_drawing_is_left_out() {
    let good = svg();
    let inside = |addition: &str| good.replacen("</title>", &format!("</title>{addition}"), 1);
    let bad = [
        inside("<script>alert(1)</script>"),
        inside("<foreignObject></foreignObject>"),
        inside("<image x=\"0\"/>"),
        inside("<rect onclick=\"alert(1)\"/>"),
        inside("<rect x=\"1\"onload=\"alert(1)\"/>"),
        inside("<path fill=\"url(http://x)\"/>"),
        inside("</svg><p>outside</p><svg>"),
        inside("<!-- -->"),
        good.replacen("<svg ", "<svg onload=\"alert(1)\" ", 1),
        format!("{good}<p>after</p>"),
        "not a picture".to_owned(),
        "<svg".to_owned(),
        String::new(),
    ];
    for svg in bad {
        let html = page(vec![drawing(&svg)]);
        assert!(
            html.contains("was left out") && !html.contains("alert"),
            "{svg}"
        );
        assert!(!html.contains("<svg"), "{svg}");
    }
    assert!(!page(vec![drawing(&good)]).contains("was left out"));
}

#[test]
fn the_page_is_the_same_twice_and_its_drawing_survives() {
    assert_eq!(page(vec![drawing(&svg())]), page(vec![drawing(&svg())]));
    // apart from the rules of its dark colours, which the page has once for all its figures
    let (head, rest) = svg()
        .split_once("<style>")
        .map(|(a, b)| (a.to_owned(), b.to_owned()))
        .unwrap();
    let (_, drawn) = rest.split_once("</style>\n").unwrap();
    let html = page(vec![drawing(&svg()), drawing(&svg())]);
    assert_eq!(
        html.matches(&format!("{head}{}", drawn.trim_end())).count(),
        2
    );
    assert_eq!(
        html.matches("prefers-color-scheme").count(),
        2,
        "one for text, one for figures"
    );
}

#[test]
fn a_notice_has_the_colour_of_its_tone_and_a_fold_is_closed() {
    let notice = |tone| {
        page(vec![Block::Notice {
            tone,
            label: "next".to_owned(),
            text: "record again".to_owned(),
        }])
    };
    assert!(notice(Tone::Good).contains("class=\"verdict good\""));
    assert!(notice(Tone::Bad).contains("class=\"verdict bad\""));
    assert!(notice(Tone::Neutral).contains("class=\"verdict\""));
    let folded = page(vec![Block::Folded {
        summary: "more".to_owned(),
        blocks: vec![Block::List(vec!["inside".to_owned()])],
    }]);
    assert!(folded.contains("<details><summary>more</summary><ul><li>inside</li></ul></details>"));
}

/// A command that is copied from the page keeps its own spaces.
#[test]
fn a_number_and_its_sign_stay_on_one_line() {
    let said = page(vec![Block::Paragraph("97 % of `a %`".to_owned())]);
    assert!(
        said.contains("<p>97\u{a0}% of <code>a %</code></p>"),
        "{said}"
    );
    let led = Document::new("A title", "97 % by `a %`", Vec::new()).to_html();
    assert!(led.contains("97\u{a0}% by <code>a %</code>"), "{led}");
}

#[test]
fn names_between_backticks_are_set_apart_and_a_single_one_stays() {
    let said = |text: &str| page(vec![Block::Paragraph(text.to_owned())]);
    let named = said("set `a<b` in `c`");
    assert!(
        named.contains("<p>set <code>a&lt;b</code> in <code>c</code></p>"),
        "{named}"
    );
    assert!(said("a ` alone").contains("<p>a ` alone</p>"));
}

#[test]
fn a_link_leads_to_a_file_of_the_folder_and_nowhere_else() {
    let link = |file: &str| {
        let text = "<what>".to_owned();
        let file = file.to_owned();
        page(vec![Block::Links(vec![Link { file, text }])])
    };
    let good = link("gap-2.html");
    assert!(good.contains("<a href=\"gap-2.html\">gap-2.html</a>: &lt;what&gt;"));
    for file in [
        "javascript:alert(1)",
        "https://x.org/a",
        "../a",
        "a/b",
        "\"><b>",
    ] {
        let html = link(file);
        assert_eq!(html.matches("<a href=\"#").count(), 2, "the contents");
        assert_eq!(html.matches("<a href").count(), 2, "{file}");
    }
}

#[test]
fn a_command_can_be_copied_and_no_other_script_runs() {
    let command = |command: &str| Block::Command {
        purpose: "Look <again>".to_owned(),
        command: command.to_owned(),
    };
    let folded = Block::Folded {
        summary: "more".to_owned(),
        blocks: vec![command("haptical check 'a<b.toml'")],
    };
    let html = page(vec![folded]);
    assert!(
        html.contains("<pre class=\"command\" tabindex=\"0\"><span>haptical</span> <span>check</span> <span>'a&lt;b.toml'</span></pre>")
    );
    // the button is the script's work: without it, and in print, there is none
    assert!(!html.contains("<button") && html.contains("Look &lt;again&gt;"));
    let (_, rest) = html.split_once("<script>").unwrap();
    let (script, rest) = rest.split_once("</script>").unwrap();
    assert!(
        !rest.contains("<script")
            && html.contains(&format!("script-src 'sha256-{}'", base64_sha256(script)))
    );
    assert!(!page(vec![drawing(&svg())]).contains("script"));
}

/// SHA-256 in base64, as a content security policy has it.
fn base64_sha256(text: &str) -> String {
    use sha2::{Digest, Sha256};
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digest = Sha256::digest(text.as_bytes());
    let mut coded = String::new();
    for triple in digest.chunks(3) {
        let byte = |index: usize| u32::from(triple.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            coded.push(match place <= triple.len() {
                true => char::from(DIGITS[(bits >> (18 - 6 * place) & 63) as usize]),
                false => '=',
            });
        }
    }
    coded
}

#[test]
fn folded_sections_are_their_own_contents() {
    let answer = Section::new("", vec![Block::Paragraph("answer".to_owned())]);
    let rest = Section::new("<Rest>", vec![Block::Paragraph("rest".to_owned())]).folded();
    let html = Document::new("T", "", vec![answer, rest]).to_html();
    assert!(!html.contains("<nav"));
    let wanted = "<details class=\"section\"><summary><h2>&lt;Rest&gt;</h2></summary><section id=\"section-2\"><p>rest</p>";
    assert!(html.contains(wanted), "{html}");
    assert!(html.contains("<section id=\"section-1\"><p>answer</p>"));
}

#[test]
fn a_wide_picture_says_that_it_goes_on_and_figures_stand_side_by_side() {
    let wide = svg().replacen(" width=\"400\"", " width=\"800\"", 1);
    let html = page(vec![drawing(&svg()), drawing(&wide)]);
    assert_eq!(html.matches("goes on to the right").count(), 1);
    assert!(html.contains("<div class=\"figures\"><figure class=\"drawing\">"));
    assert!(html.contains("<figure class=\"drawing wide\">"));
}

#[test]
fn a_wide_table_has_its_heads_at_every_cell() {
    let table = |heads: &str, count: usize| {
        let row = vec![Cell::number(1.5, 1); count];
        page(vec![
            Table::with_heads("", heads)
                .with_rows([row])
                .unwrap()
                .into(),
        ])
    };
    let wide = table("a | b [mm] | c | d", 4);
    assert!(wide.contains("class=\"stack\"") && wide.contains("data-label=\"b [mm]\">1.5</td>"));
    assert!(!table("a | b [mm] | c", 3).contains("data-label=\""));
}
