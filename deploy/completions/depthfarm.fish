# fish completion of depthfarm, depthfarm-coordinator and depthfarm-worker: what the programs' own --help says.

function __depthfarm_commands
    $argv --help 2>/dev/null | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on {name = $1; sub(/^ *[^ ]+ +/, ""); print name "\t" $0}'
end

# The program and its commands, as far as they are written.
function __depthfarm_command
    set -l words (commandline -opc)
    set -l command $words[1]
    for word in $words[2..-1]
        set -l commands (__depthfarm_commands $command | string replace -r '\t.*' '')
        contains -- $word $commands; or break
        set -a command $word
    end
    string join \n -- $command
end

function __depthfarm_complete
    set -l command (__depthfarm_command)
    set -l current (commandline -ct)
    set -l previous (commandline -opc)[-1]
    if string match -q -- '-*' $current
        $command --help 2>/dev/null | sed -n 's/^  \(-[A-Za-z],\)\{0,1\}\(--[a-z0-9-]*\).*/\2/p'
        return
    end
    set -l value
    if string match -q -- '--*' $previous
        set value ($command --help 2>/dev/null | sed -n "s/^  \(-[A-Za-z],\)\{0,1\}$previous \([^ =]*\).*/\2/p" | head -n 1)
    end
    set -l commands (__depthfarm_commands $command)
    if string match -q -- '*|*' "$value"
        string split '|' -- $value | string match -r '^[a-z][a-z0-9]*$'
    else if test (count $commands) -gt 0
        string join \n -- $commands
    else
        __fish_complete_path $current
    end
end

for program in depthfarm depthfarm-coordinator depthfarm-worker
    complete -c $program -f -a '(__depthfarm_complete)'
end
