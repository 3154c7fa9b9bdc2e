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
    for word in ["<script", "<link", "src=", "@import", "url("] {
        assert!(!html.contains(word), "{word}");
    }
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
    assert!(page(vec![drawing(&svg())]).contains(svg().trim_end()));
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
