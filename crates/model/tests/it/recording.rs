//! Rows of a recording chosen and put in another order.

use haptical_model::{AddedBy, AddedReadings, Recording};

/// What an effect adds to an encoder.
fn added(readings: Vec<f64>, slopes: Vec<Vec<f64>>) -> AddedReadings {
    AddedReadings {
        effect: 1,
        channel: "out2".to_owned(),
        axis: 0,
        by: AddedBy::default(),
        readings,
        at: vec![0.5, -0.5],
        slopes,
    }
}

#[test]
fn every_column_follows_the_chosen_rows() {
    let column = |offset: f64| vec![offset, offset + 1.0, offset + 2.0, offset + 3.0];
    let recording = Recording {
        line: vec![2, 3, 4, 5],
        time_s: Some(column(10.0)),
        run: Some(vec![1, 1, 2, 2]),
        joint: vec![column(20.0), column(30.0)],
        output: vec![Some(column(40.0)), None],
        cable_m: vec![Some(column(50.0))],
        position_m: Some([column(60.0), column(70.0), column(80.0)]),
        orientation_wxyz: Some([column(90.0), column(100.0), column(110.0), column(120.0)]),
        torque_nm: vec![None, Some(column(130.0))],
        force_n: Some([column(140.0), column(150.0), column(160.0)]),
        temperature_degc: Some(column(170.0)),
        hand: Some(
            ["left", "right", "left", "left"]
                .map(str::to_owned)
                .to_vec(),
        ),
        contact: Some(["p", "", "q", "p"].map(str::to_owned).to_vec()),
        plane: Some(["", "a", "", "b"].map(str::to_owned).to_vec()),
        tool: Some(["t", "", "t", "u"].map(str::to_owned).to_vec()),
        covariates: vec![("humidity".to_owned(), column(180.0))],
        added: vec![added(column(190.0), vec![column(200.0), column(210.0)])],
    };
    let picked = |offset: f64| vec![offset + 3.0, offset + 1.0];
    let expected = Recording {
        line: vec![5, 3],
        time_s: Some(picked(10.0)),
        run: Some(vec![2, 1]),
        joint: vec![picked(20.0), picked(30.0)],
        output: vec![Some(picked(40.0)), None],
        cable_m: vec![Some(picked(50.0))],
        position_m: Some([picked(60.0), picked(70.0), picked(80.0)]),
        orientation_wxyz: Some([picked(90.0), picked(100.0), picked(110.0), picked(120.0)]),
        torque_nm: vec![None, Some(picked(130.0))],
        force_n: Some([picked(140.0), picked(150.0), picked(160.0)]),
        temperature_degc: Some(picked(170.0)),
        hand: Some(["left", "right"].map(str::to_owned).to_vec()),
        contact: Some(["p", ""].map(str::to_owned).to_vec()),
        plane: Some(["b", "a"].map(str::to_owned).to_vec()),
        tool: Some(["u", ""].map(str::to_owned).to_vec()),
        covariates: vec![("humidity".to_owned(), picked(180.0))],
        added: vec![added(picked(190.0), vec![picked(200.0), picked(210.0)])],
    };
    assert_eq!(recording.select(&[3, 1]), expected);
    assert_eq!(
        (recording.len(), recording.select(&[]).is_empty()),
        (4, true)
    );
    assert_eq!(Recording::default().len(), 0);
}
