# shellcheck shell=bash
# Sourced by the tests in this folder, from the repository's root: wrong <what> [output ...]
wrong() {
  printf '%s\n' "$@"
  exit 1
}
