//! The project's own jobs: `cargo xtask reproduce-tables`, `blind-check`, `bench-peers` and others.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command talks to its terminal"
)]

mod mutants;
mod real_arms;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use xtask_paper::{experiment, tables};
use xtask_peers::{bench_peers, bench_scaling, descriptions, instructions, moving, whole};

/// Jobs of the Haptical project.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    /// Reproduces the paper's simulation: Tables 1 to 3, Figures 7 and 8, and what they rest on.
    ReproduceTables(tables::Arguments),
    /// Reproduces the paper's experiment on a virtual device: Tables 4 and 5 and what they improve.
    ReproduceExperiment(experiment::Arguments),
    /// Tries the diagnosis on recordings with sealed truths, then opens and scores them.
    BlindCheck(xtask_trials::Arguments),
    /// Records ambiguous trials again, along the motion that `plan --settle` chooses and along others.
    SettleCheck(xtask_trials::SettleArguments),
    /// Compares ours with Ceres, SciPy and Pinocchio on the same files, where they are there.
    BenchPeers(bench_peers::Arguments),
    /// Processor time and memory of whole commands over the rows of their logs.
    BenchWhole(whole::Arguments),
    /// MuJoCo's system identification and diagnose on logs of a moving arm with withheld effects.
    PeersMoving(moving::Arguments),
    /// Compares kinematics, torques and exports of public URDFs and MJCFs with Pinocchio and MuJoCo; ends with an error where a
    /// difference is not named.
    Descriptions(descriptions::Arguments),
    /// Measures how time and memory grow with poses, parameters and joints.
    BenchScaling(bench_scaling::Arguments),
    /// Computes the figures of docs/evidence.md and writes it.
    Evidence(xtask_evidence::Arguments),
    /// Identifies and diagnoses the golden scenes and compares the whole answers with the recorded ones.
    CompareResults(xtask_scenes::Arguments),
    /// Changes the golden scenes in ways that no answer may depend on, and compares with the list of laws that are broken.
    Laws(xtask_scenes::LawsArguments),
    /// Runs every command that diagnose and identify print for a golden scene, where they were run.
    PrintedCommands(xtask_scenes::PrintedArguments),
    /// Runs identify and diagnose on measured data of real arms, and writes docs/real-arms.md.
    RealArms(real_arms::Arguments),
    /// Counts the instructions of fixed workloads and compares them with the committed numbers.
    Instructions(instructions::Arguments),
    /// Plants small faults of the maths one after the other in a copy of the sources, and expects that named tests catch each.
    Mutants(mutants::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().job {
        Job::ReproduceTables(arguments) => tables::reproduce(&arguments),
        Job::ReproduceExperiment(arguments) => experiment::reproduce(&arguments),
        Job::BlindCheck(arguments) => xtask_trials::check(&arguments),
        Job::SettleCheck(arguments) => xtask_trials::settle(&arguments),
        Job::BenchPeers(arguments) => bench_peers::bench(&arguments),
        Job::BenchWhole(arguments) => whole::run(&arguments),
        Job::PeersMoving(arguments) => moving::run(&arguments),
        Job::Descriptions(arguments) => descriptions::run(&arguments),
        Job::BenchScaling(arguments) => bench_scaling::measure(&arguments),
        Job::Evidence(arguments) => xtask_evidence::evidence(&arguments),
        Job::CompareResults(arguments) => xtask_scenes::compare_results(&arguments),
        Job::Laws(arguments) => xtask_scenes::laws(&arguments),
        Job::PrintedCommands(arguments) => xtask_scenes::printed_commands(&arguments),
        Job::RealArms(arguments) => real_arms::run(&arguments),
        Job::Instructions(arguments) => instructions::instructions(&arguments),
        Job::Mutants(arguments) => mutants::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
