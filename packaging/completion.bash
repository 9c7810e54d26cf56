# Bash completion of `vantage`: commands and flags from the output of --help, otherwise file names.
_vantage() {
  local word said current=${COMP_WORDS[COMP_CWORD]} commands=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ "$word" =~ ^[a-z][a-z0-9-]*$ ]] || break
    commands+=("$word")
  done
  said=$("${COMP_WORDS[0]}" "${commands[@]}" --help 2> /dev/null) || return
  mapfile -t COMPREPLY < <(compgen -W "$(
    grep -oE -- '--[a-z][a-z0-9-]*' <<< "$said"
    sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z0-9-]*\) .*/\1/p' <<< "$said")" -- "$current" | sort -u)
}
complete -o default -F _vantage vantage
