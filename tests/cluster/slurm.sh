# A cluster of two nodes on this machine, for tests: sourced. Needs neither root nor systemd; ports, key, sockets and
# states are its own. start_cluster FOLDER [CPUS A NODE], stop_cluster; node_up NAME, node_down NAME.
# shellcheck shell=sh
# shellcheck disable=SC2034 # SLURM_CONF is for Slurm's own programs

# Two free ports in a row and one more, told by the system.
free_ports() {
    python3 -c '
import socket
sockets = [socket.socket() for _ in range(3)]
for each in sockets: each.bind(("127.0.0.1", 0))
print(*(each.getsockname()[1] for each in sockets))'
}

start_cluster() {
    cluster=$1 cpus=${2:-1}
    mkdir -p "$cluster/ctld" "$cluster/munge" "$cluster/n1" "$cluster/n2"
    chmod 755 "$cluster" "$cluster/munge"
    (umask 077 && head -c 1024 /dev/urandom >"$cluster/munge/key")
    # shellcheck disable=SC2046 # three numbers
    set -- $(free_ports)
    host=$(uname -n)
    SLURM_CONF="$cluster/slurm.conf"
    export SLURM_CONF
    cat >"$SLURM_CONF" <<CONF
ClusterName=delio
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$1
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$cluster/ctld
SlurmctldPidFile=$cluster/ctld.pid
SlurmctldLogFile=$cluster/ctld.log
SlurmdSpoolDir=$cluster/%n
SlurmdPidFile=$cluster/%n.pid
SlurmdLogFile=$cluster/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MailProg=/bin/true
MpiDefault=none
ReturnToService=2
SlurmdTimeout=${SLURMD_TIMEOUT:-4}
SlurmdParameters=config_overrides
SchedulerParameters=${SCHEDULER_PARAMETERS:-batch_sched_delay=0,sched_interval=1,bf_interval=1,requeue_delay=1}
MaxArraySize=${MAX_ARRAY_SIZE:-1001}
MaxJobCount=${MAX_JOB_COUNT:-10000}
KillWait=2
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$2 CPUs=$cpus RealMemory=20000 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$3 CPUs=$cpus RealMemory=20000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    munged --foreground --force --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" \
        --pid-file="$cluster/munge/pid" --log-file="$cluster/munge/log" --seed-file="$cluster/munge/seed" \
        >"$cluster/munge/said" 2>&1 &
    munge_pid=$!
    wait_until 60 "munged" test -S "$cluster/munge/socket"
    slurmctld -D -c >"$cluster/ctld.said" 2>&1 &
    ctld_pid=$!
    node_up n1
    node_up n2
    wait_until 60 "two nodes" both_idle
}

both_idle() { [ "$(sinfo -h -N -o '%N %t' 2>/dev/null | grep -c ' idle$')" = 2 ]; }

# wait_until SECONDS WHAT COMMAND...
wait_until() {
    until=$(($(date +%s) + $1)) what=$2
    shift 2
    until "$@"; do
        if [ "$(date +%s)" -gt "$until" ]; then
            echo "$what: not there in time" >&2
            return 1
        fi
        sleep 0.1
    done
}

node_up() {
    slurmd -D -N "$1" >"$cluster/$1.said" 2>&1 &
    eval "$1_pid=$!"
}

# With all that it runs, as a machine that loses its power.
node_down() {
    eval "kill -9 \$$1_pid" 2>/dev/null || true
    for step in $(steps_of "$1"); do
        for process in $(with_children "$step"); do kill -9 "$process" 2>/dev/null || true; done
    done
    eval "wait \$$1_pid" 2>/dev/null || true
}

# Processes that slurmd NODE has started: slurmstepd detaches itself, its log tells whose it is.
steps_of() {
    # shellcheck disable=SC2013 # words are wanted
    for comm in $(grep -lx slurmstepd /proc/[0-9]*/comm 2>/dev/null); do
        step=${comm%/comm}
        for file in "$step"/fd/*; do
            [ "$(readlink "$file" 2>/dev/null)" != "$cluster/$1.log" ] || echo "${step#/proc/}"
        done
    done
}

with_children() {
    echo "$1"
    # shellcheck disable=SC2013 # words are wanted
    for child in $(cat "/proc/$1/task/"*/children 2>/dev/null); do with_children "$child"; done
}

stop_cluster() {
    [ -n "${cluster:-}" ] || return 0
    scancel -u "$(id -un)" 2>/dev/null || true
    for node in n1 n2; do node_down $node; done
    for process in "${ctld_pid:-}" "${munge_pid:-}"; do
        [ -z "$process" ] || kill "$process" 2>/dev/null || true
    done
    wait 2>/dev/null || true
    cluster=
}
