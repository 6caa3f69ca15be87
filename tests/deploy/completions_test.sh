#!/usr/bin/env bash
# What the shells complete, asked of the real shells that are here; and that manuals hold every option.
# usage: completions_test.sh SOURCE-FOLDER PROGRAM-FOLDER [MANUAL-FOLDER]
set -euo pipefail
completions=$1/deploy/completions
export PATH=$2:$PATH
manuals=${3:-}
fail() { echo "FAILED: $*" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
touch "$folder/scene.json"

# shellcheck disable=SC1091
source "$completions/depthfarm.bash"
in_bash() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _depthfarm "$1"
  echo "${COMPREPLY[*]}"
}
expect() {
  local expected=$1 given
  shift
  given=$(in_bash "$@")
  [ "$given" = "$expected" ] || fail "bash: '$*' gives '$given', expected '$expected'"
}
expect run depthfarm ru
expect "up status down" depthfarm cluster ""
expect "local slurm ssh" depthfarm cluster up --engine ""
expect "default best fast paper" depthfarm run --preset ""
expect "debug info warning error off" depthfarm run --log-level ""
expect --submit depthfarm synthesize --su
expect --slots depthfarm-worker --slo
expect "$folder/scene.json" depthfarm run "$folder/sc"
expect "$folder/scene.json" depthfarm run --params "$folder/sc"
# Every option of every command.
commands=$(_depthfarm_commands depthfarm)
[ "$(wc -w <<<"$commands")" -ge 20 ] || fail "commands are '$commands'"
for command in $commands; do
  listed=$(depthfarm "$command" --help | grep -cE '^  (-[A-Za-z],)?--' || true)
  given=$(in_bash depthfarm "$command" - | wc -w)
  [ "$listed" = "$given" ] || fail "bash: $command has $listed options, $given are completed"
  if [ -n "$manuals" ]; then
    manual=$(zcat "$manuals/cli/depthfarm-$command.1.gz" | sed 's/\\//g')
    for option in $(in_bash depthfarm "$command" -); do
      grep -qF -e "$option" <<<"$manual" || fail "manual of $command lacks $option"
    done
  fi
done

if command -v fish >/dev/null; then
  given=$(fish -c "source $completions/depthfarm.fish; complete -C 'depthfarm cluster up --engine s'" | sort | tr '\n' ' ')
  [ "$given" = "slurm ssh " ] || fail "fish: engines are '$given'"
  fish -c "source $completions/depthfarm.fish; complete -C 'depthfarm ru'" | grep -q '^run' || fail "fish: no command run"
  fish -c "source $completions/depthfarm.fish; complete -C 'depthfarm run --pre'" | grep -qx -e --preset || fail "fish: no --preset"
else
  echo "no fish here: its completion was not tried"
fi

if command -v zsh >/dev/null; then
  cat >"$folder/drive.zsh" <<'END'
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1=; fpath=($1 \$fpath); autoload -U compinit; compinit -u -D; print ready"
zpty -r shell text '*ready*'
shift
for begun complete; do
  zpty -n -w shell $'\C-u'"$begun"$'\t'
  text=
  repeat 400 { zpty -r -t shell more && text+=$more; [[ $text == *$complete* ]] && break; sleep 0.05 }
  print -r -- "$text"
done
END
  text=$(timeout 100 zsh -f "$folder/drive.zsh" "$completions" "depthfarm ru" run "depthfarm cluster up --engine sl" \
    slurm "depthfarm run --pres" --preset | cat -v)
  for word in run slurm --preset; do grep -qF -e "$word" <<<"$text" || fail "zsh: no $word in: $text"; done
else
  echo "no zsh here: its completion was not tried"
fi

if [ -n "$manuals" ] && command -v mandoc >/dev/null; then
  for page in "$manuals"/*/*.gz; do
    said=$(mandoc -Tlint -W warning "$page" || true)
    [ -z "$said" ] || fail "$said"
  done
fi
echo "completions and manuals: all is well"
