#!/usr/bin/env bash
# Builds the page: `bash outside/web/build.sh [PROFILE] [FOLDER]` writes FOLDER/index.html with FOLDER/haptical.wasm.gz,
# for any static host, and FOLDER/haptical.html, one file that opens by a double click. FOLDER is outside/web/dist unless said. Needs cargo with rustup, and npm.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

profile=${1:-release}
out=${2:-outside/web/dist}
readonly TARGET=wasm32-wasip1

if ! [[ -d $(rustc --print sysroot)/lib/rustlib/$TARGET ]]; then
    rustup target add "$TARGET"
fi
# rosbag2 is C, which has no compiler for this target here
cargo build --profile "$profile" --target "$TARGET" --package haptical-cli --no-default-features \
    --features archives,mcap,parquet --locked
if ! [[ outside/web/node_modules/.package-lock.json -nt outside/web/package-lock.json ]]; then
    npm ci --prefix outside/web --no-audit --no-fund
fi
# a build for tests is larger
size=()
if [[ $profile != release ]]; then size=(any-size); fi
node outside/web/build.mjs "target/$TARGET/$profile/haptical.wasm" "$out" ${size[@]+"${size[@]}"}
