//! The order of times and runs.

use haptical_data::Fault;

use crate::support::{clean, refused, single};

#[test]
fn time_increases_within_a_run() {
    for (time, earlier) in [("1.5", 1.5), ("1.4", 1.5)] {
        let text = format!("theta1_rad,t_s\n0,1\n\n0,1.5\n0,{time}\n");
        let error = refused(&text, &single(), "time-order", Some(5), Some((2, "t_s")));
        let Fault::TimeOrder {
            time_s,
            previous_line,
            previous_s,
            ..
        } = &error.fault
        else {
            panic!("another variant: {error}");
        };
        assert_eq!(time_s.to_string(), time);
        assert_eq!((*previous_line, *previous_s), (4, earlier));
        assert!(error.to_string().contains("1.5 s of line 4"), "{error}");
    }
}

#[test]
fn a_missing_time_does_not_hide_a_step_back() {
    let text = "theta1_rad,t_s\n0,1\n0,\n0,0.5\n";
    refused(text, &single(), "time-order", Some(4), Some((2, "t_s")));
}

#[test]
fn time_starts_again_with_a_new_run_only() {
    clean(
        "run,t_s,theta1_rad\n7,0,0\n7,1,0\n2,0,0\n2,1,0\n",
        &single(),
    );
    let text = "run,t_s,theta1_rad\n7,0,0\n7,1,0\n2,0,0\n2,0,0\n";
    refused(text, &single(), "time-order", Some(5), Some((2, "t_s")));
}

#[test]
fn the_rows_of_a_run_are_contiguous() {
    let text = "theta1_rad,run\n0,1\n0,1\n0,2\n0,3\n0,1\n";
    let error = refused(
        text,
        &single(),
        "run-not-contiguous",
        Some(6),
        Some((2, "run")),
    );
    assert!(
        matches!(
            error.fault,
            Fault::RunNotContiguous {
                run: 1,
                previous_line: 3,
                ..
            }
        ),
        "{error}"
    );
}
