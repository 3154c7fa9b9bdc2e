//! The page as one HTML file: text and tables by maud, style, script and data embedded.

use haptical::files::Record;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::recorded::Recorded;
use super::summary::rms_texts;
use crate::failure::Failure;

const STYLE: &str = include_str!("page.css");
/// The scripts run one after the other in one element: the first two hold functions only.
const SCRIPTS: [&str; 3] = [
    include_str!("arm.js"),
    include_str!("plots.js"),
    include_str!("player.js"),
];
/// Speeds to choose from: how many times as fast as the device moved.
const SPEEDS: [&str; 6] = ["0.1", "0.25", "0.5", "1", "2", "5"];

/// The page of a recorded log; `log` is the name to show, `record` how it came about.
pub(super) fn page(recorded: &Recorded, log: &str, record: &Record) -> Result<String, Failure> {
    let title = "Playback of a log";
    let lines = record.lines()?;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                // The page runs its own script and loads nothing.
                meta http-equiv="Content-Security-Policy"
                    content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";
                title { (title) ": " (printable(&recorded.device)) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (title) }
                    p.lead { (lead(recorded, log)) }
                    noscript { p.note {
                        "This page plays with JavaScript, which is switched off here. The table \
                         still holds the sizes of the errors."
                    } }
                }
                main {
                    div.stage {
                        (arm(recorded))
                        (numbers(recorded))
                    }
                    (controls(recorded))
                    (plots(recorded))
                    (keys())
                    (provenance(&lines))
                }
                script type="application/json" id="data" { (PreEscaped(embedded(recorded)?)) }
                script { @for script in SCRIPTS { (PreEscaped(script)) } }
            }
        }
    };
    Ok(page.into_string())
}

/// The data as JSON that cannot end its own element: `</` and `<!--` need a `<`.
fn embedded(recorded: &Recorded) -> Result<String, Failure> {
    let json = serde_json::to_string(recorded).map_err(Failure::internal)?;
    Ok(json.replace('<', "\\u003c"))
}

/// Control characters of names become spaces.
fn printable(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(plain).collect()
}

fn lead(recorded: &Recorded, log: &str) -> String {
    let thinned = match recorded.every {
        1 => "all rows".to_owned(),
        every => format!("one row in {every}"),
    };
    let arms = match recorded.calibrated {
        true => "the nominal arm and the calibrated one",
        false => "the nominal arm",
    };
    format!(
        "{}: {arms} at the readings of {} ({} of {} rows, {thinned}).",
        printable(&recorded.device),
        printable(log),
        recorded.len(),
        recorded.rows
    )
}

fn arm(recorded: &Recorded) -> Markup {
    html! {
        figure {
            svg #arm viewBox="0 0 800 560" role="img" tabindex="0"
                aria-labelledby="arm-title arm-text" {
                title #arm-title { "The arm as a stick figure" }
                desc #arm-text { "Drag, or use the arrow keys, to turn the view." }
            }
            figcaption {
                ul.legend {
                    li { span.swatch.nominal {} "nominal arm, dashed, handle: square" }
                    @if recorded.calibrated {
                        li { span.swatch.calibrated {}
                            "calibrated arm, handle: circle; its deviation drawn "
                            output.gain { "1" } " times" }
                    }
                    @if recorded.channels.iter().any(|channel| channel.exit_um.is_some()) {
                        li { span.swatch.measured.diamond {}
                            "end of the measured cable on the line to each handle; the error drawn "
                            output.gain { "1" } " times" }
                    }
                    @if recorded.tracked_um.is_some() {
                        li { span.swatch.measured.cross {}
                            "tracked handle; its distance from the nominal one drawn "
                            output.gain { "1" } " times" }
                    }
                    @if !recorded.effects.is_empty() {
                        li { "effects in the " (if recorded.calibrated { "calibrated" } else { "nominal" })
                            " arm: " (printable(&recorded.effects.join(", ")))
                            "; the errors and the handle show them, the frames in between joint-compliance alone" }
                    }
                    li { span.swatch.fixed {} "from the cable's frame (−1) to the base" }
                }
            }
        }
    }
}

/// The numbers at the cursor and those of the whole page: the text form of the plots.
fn numbers(recorded: &Recorded) -> Markup {
    html! {
        div.numbers {
            p #now aria-live="off" { }
            @if recorded.channels.is_empty() {
                p.note { "The log has no measurement of this device, so there are no errors." }
            } @else {
                div.scroll { table {
                    caption { "Errors, model minus measurement: at the cursor, and their root mean \
                               square (RMS) over the rows of the page" }
                    thead { tr {
                        th.text scope="col" { "channel" }
                        th scope="col" { "nominal now" }
                        th scope="col" { "RMS" }
                        @if recorded.calibrated {
                            th scope="col" { "calibrated now" }
                            th scope="col" { "RMS" }
                        }
                    } }
                    tbody {
                        @for (index, channel) in recorded.channels.iter().enumerate() {
                            @let [nominal, calibrated] = rms_texts(channel);
                            tr {
                                th.text scope="row" { (channel.name) " [" (channel.unit) "]" }
                                td id=(format!("nominal-{index}")) { "–" }
                                td { (nominal) }
                                @if recorded.calibrated {
                                    td id=(format!("calibrated-{index}")) { "–" }
                                    td { (calibrated) }
                                }
                            }
                        }
                    }
                } }
            }
        }
    }
}

fn controls(recorded: &Recorded) -> Markup {
    let last = recorded.len().saturating_sub(1);
    let pace = match recorded.axis.is_time {
        true => "times real time",
        false => "times 25 rows a second",
    };
    html! {
        div.controls role="group" aria-label="Playback" {
            button #play type="button" { "Play" }
            input #at type="range" min="0" max=(last) step="1" value="0" aria-label="Row";
            label { "Speed "
                select #speed aria-label=(format!("Speed, {pace}")) {
                    @for speed in SPEEDS {
                        option value=(speed) selected[speed == "1"] { (speed) "×" }
                    }
                }
            }
            label { "Deviation drawn "
                input #gain type="range" min="0" max="7" step="1" value="3";
                output.gain { "10" } " times"
            }
            span {
                button #farther type="button" aria-label="Zoom out" { "−" }
                button #nearer type="button" aria-label="Zoom in" { "+" }
                button #front type="button" { "Reset view" }
            }
        }
    }
}

fn plots(recorded: &Recorded) -> Markup {
    html! {
        section aria-label="Errors over the log" {
            @if !recorded.channels.is_empty() {
                h2 { "Errors over " (if recorded.axis.is_time { "time [s]" } else { "rows" }) }
                p.note { "Model minus measurement. A gap in a curve is a missing reading, a change \
                          of run, or a reading outside the range of a fitted polynomial. Click into \
                          a plot to go there." }
                p.note.sign { "The plots go on to the right: swipe them." }
                div #plots { }
            }
        }
    }
}

fn keys() -> Markup {
    html! {
        p.note {
            "Keys: space plays and pauses; left and right go one row back and on, with shift ten \
             rows; home and end go to the ends; plus and minus zoom. When the arm has the focus, the \
             arrow keys turn the view."
        }
    }
}

/// How the page came about, folded away.
fn provenance(lines: &[(String, String)]) -> Markup {
    html! {
        details.note {
            summary { "Provenance" }
            dl {
                @for (what, value) in lines {
                    dt { (what) }
                    dd { (printable(value)) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::play::recorded::Axis;

    fn recorded(device: &str) -> Recorded {
        Recorded {
            device: device.to_owned(),
            calibrated: false,
            effects: Vec::new(),
            rows: 1,
            every: 1,
            axis: Axis {
                is_time: false,
                values: vec![1.0],
            },
            run_starts: Vec::new(),
            up: [0.0, 0.0, 1.0],
            origins_um: vec![vec![0; 9]],
            deviations_um: None,
            tracked_um: None,
            channels: Vec::new(),
        }
    }

    #[test]
    fn names_cannot_leave_their_place() {
        let name = "a</script><script>alert(1)</script><!-- \u{7}&";
        let record = Record::new("0", "play", vec![name.to_owned()], Vec::new());
        let page = page(&recorded(name), name, &record).unwrap();
        // the two elements of the page itself
        assert_eq!(page.matches("<script").count(), 2);
        assert_eq!(page.matches("</script").count(), 2);
        assert!(!page.contains("<!--") && !page.contains('\u{7}'));
        let (_, rest) = page.split_once("id=\"data\">").unwrap();
        let (json, _) = rest.split_once("</script>").unwrap();
        let data: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(data["device"], name);
    }
}
