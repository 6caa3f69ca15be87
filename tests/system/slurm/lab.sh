#!/usr/bin/env bash
# A private Slurm on this machine: munged, slurmctld and N slurmd, no root, no systemd, nothing outside FOLDER.
# usage: lab.sh up FOLDER N PORT     nodes w1 ... wN; ports PORT to PORT+N are taken
#        lab.sh down FOLDER
# `up` returns when all nodes are idle; then SLURM_CONF=FOLDER/slurm.conf.
set -euo pipefail

up() {
  local folder=$1 nodes=$2 port=$3 me munged
  me=$(id -un)
  # Daemons of Debian are in /usr/sbin, which is not in everybody's PATH.
  PATH=$PATH:/usr/sbin
  mkdir -p "$folder"/{munge,state,spool,log}
  chmod 711 "$folder"
  chmod 755 "$folder/munge"
  head -c 128 /dev/urandom >"$folder/munge/key"
  chmod 600 "$folder/munge/key"
  cat >"$folder/slurm.conf" <<END
ClusterName=lab
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$me
SlurmdUser=$me
AuthType=auth/munge
AuthInfo=socket=$folder/munge/sock,cred_expire=5
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=2,sched_min_interval=0,batch_sched_delay=1
SlurmdParameters=config_overrides
ReturnToService=1
SlurmdTimeout=10
SlurmctldTimeout=10
InactiveLimit=0
KillWait=5
MinJobAge=300
NodeName=w[1-$nodes] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + nodes))] CPUs=2 RealMemory=8000 State=UNKNOWN
PartitionName=batch Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
  printf 'CgroupPlugin=cgroup/v1\nConstrainCores=no\nConstrainRAMSpace=no\n' >"$folder/cgroup.conf"
  export SLURM_CONF=$folder/slurm.conf
  munged --force --key-file="$folder/munge/key" --socket="$folder/munge/sock" --pid-file="$folder/munge/pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" --num-threads=4
  slurmctld -c
  for i in $(seq 1 "$nodes"); do slurmd -N "w$i"; done
  for _ in $(seq 1 300); do
    if [ "$(sinfo -h -o %T -N 2>/dev/null | grep -c idle)" = "$nodes" ]; then return; fi
    sleep 0.1
  done
  echo "lab.sh: the nodes did not come up, see $folder/log" >&2
  exit 1
}

down() {
  local folder=$1 pid_file
  export SLURM_CONF=$folder/slurm.conf
  scancel --quiet --me 2>/dev/null || true
  scontrol shutdown slurmctld >/dev/null 2>&1 || true
  for pid_file in "$folder"/w*.pid "$folder"/slurmctld.pid "$folder"/munge/pid; do
    if [ -s "$pid_file" ]; then kill "$(cat "$pid_file")" 2>/dev/null || true; fi
  done
}

case "${1:-}" in
  up) up "$2" "$3" "$4" ;;
  down) down "$2" ;;
  *) sed -n 2,5p "$0" >&2; exit 2 ;;
esac
