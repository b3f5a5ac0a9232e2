# shellcheck shell=bash
# Read by the tests in this folder, from the repository's root: wrong <what> [what was said ...]
wrong() {
  printf '%s\n' "$@"
  exit 1
}
