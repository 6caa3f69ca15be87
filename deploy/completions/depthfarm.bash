# bash completion of depthfarm, depthfarm-coordinator and depthfarm-worker. What there is to complete is what the
# programs' own --help says.

# The commands that --help of these words lists.
_depthfarm_commands() {
  "$@" --help 2>/dev/null | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on {print $1}'
}

# The options that --help of these words lists.
_depthfarm_options() {
  "$@" --help 2>/dev/null | sed -n 's/^  \(-[A-Za-z],\)\{0,1\}\(--[a-z0-9-]*\).*/\2/p'
}

# The words that the option given first may take, where --help names them: a|b|c or {a,b,c}. Nothing where it takes any;
# FILES where it takes files.
_depthfarm_values() {
  local option=$1 value
  shift
  value=$("$@" --help 2>/dev/null | sed -n "s/^  \\(-[A-Za-z],\\)\\{0,1\\}$option \\([^ ]*\\).*/\\2/p" | head -n 1)
  case $value in
    *:{*}*) value=${value#*:\{} && tr ',' '\n' <<<"${value%%\}*}" ;;
    *'|'*) tr '|' '\n' <<<"${value%%=*}" | grep -E '^[a-z][a-z0-9]*$' ;;
    *) echo FILES ;;
  esac
}

_depthfarm() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=("$1") word commands values
  COMPREPLY=()
  # The command, and the command of that command.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    commands=$(_depthfarm_commands "${command[@]}")
    if [[ $word == -* ]] || ! grep -qxF -e "$word" <<<"$commands"; then break; fi
    command+=("$word")
  done
  commands=$(_depthfarm_commands "${command[@]}")
  if [[ $previous == --* ]] && _depthfarm_options "${command[@]}" | grep -qxF -e "$previous"; then
    values=$(_depthfarm_values "$previous" "${command[@]}")
    if [[ $values != FILES ]]; then
      mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current")
      return
    fi
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_depthfarm_options "${command[@]}")" -- "$current")
    return
  elif [[ -n $commands ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$current")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -f -- "$current")
  compopt -o filenames 2>/dev/null || true
}

complete -F _depthfarm depthfarm depthfarm-coordinator depthfarm-worker
