# A second machine as its network sees it: a namespace with an address of its own, at the other end of a cable
# that can be cut (tests/slurm.sh, tests/ray.sh, tests/faults.sh). To be sourced.

# Lays the cable: `lay_cable NAME 10.213.7` gives $here and $there. Fails where there are no namespaces.
lay_cable() {
    [[ $(id -u) == 0 ]] && command -v ip >/dev/null && ip netns add "$1" 2>/dev/null || return 1
    space=$1 here=$2.1 there=$2.2
    ip link add "$space-0" type veth peer name "$space-1" netns "$space"
    ip address add "$here/30" dev "$space-0"
    ip link set "$space-0" up
    ip -n "$space" address add "$there/30" dev "$space-1"
    mend_cable
    ip -n "$space" link set lo up
}
# Runs a command on the second machine. `ip netns exec` would hide /sys/fs/cgroup, which Slurm looks for.
over_there() { nsenter --net="/run/netns/$space" "$@"; }
# At the other end: without the device here, packets would go to whatever the default route leads to.
cut_cable() { ip -n "$space" link set "$space-1" down; }
mend_cable() { ip -n "$space" link set "$space-1" up; }
remove_cable() { [[ -z ${space:-} ]] || ip netns delete "$space" 2>/dev/null || true; }
