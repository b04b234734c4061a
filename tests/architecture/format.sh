#!/usr/bin/env bash
# Every source as clang-format leaves it (.clang-format). Exit 77 (skipped) where clang-format is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v clang-format >/dev/null || { echo "skipped: clang-format is not installed"; exit 77; }
find core server client tests -name '*.h' -print0 -o -name '*.cc' -print0 | sort -z |
  xargs -0 -r clang-format --dry-run --Werror --ferror-limit=3
