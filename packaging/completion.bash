# bash completion for wholehand: subcommands and options as the program's own --help lists them.
_wholehand() {
  local word=${COMP_WORDS[COMP_CWORD]} path=() k help
  for ((k = 1; k < COMP_CWORD; ++k)); do
    [[ ${COMP_WORDS[k]} == -* ]] && break
    path+=("${COMP_WORDS[k]}")
  done
  # A file's name is not a subcommand: shows the help of the words before it.
  while ! help=$("${COMP_WORDS[0]}" "${path[@]}" --help 2>/dev/null) && ((${#path[@]})); do
    unset 'path[-1]'
  done
  local words
  if [[ $word == -* ]]; then
    words=$(grep -oE -- '^  (-[A-Za-z],)?--[a-z0-9-]+' <<<"$help" | grep -oE -- '--.*')
  else
    words=$(sed -n '/^Subcommands:/,$ s/^  \([a-z-]\{1,\}\) .*/\1/p' <<<"$help")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _wholehand wholehand
