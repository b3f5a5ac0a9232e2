# shellcheck shell=bash
# A bare Debian 12 in a folder, made by debootstrap; needs root. Sourced: makes $bare, which is removed at the end, and
# the function `inside`.

fail() {
  echo "$*" >&2
  exit 1
}
((EUID == 0)) || fail "a bare Debian is made by root: sudo $0 $*"
command -v debootstrap >/dev/null || fail "debootstrap is missing: apt-get install debootstrap"
bare=$(mktemp -d)
trap 'umount "$bare/proc" 2>/dev/null || true; rm -rf --one-file-system "$bare"' EXIT

mirror=$(sed -nE 's/^(deb|URIs:) *(\[[^]]*\] *)?(https?:[^ ]*).*/\3/p' /etc/apt/sources.list \
  /etc/apt/sources.list.d/* 2>/dev/null | sed -n 1p || true)
echo "A bare Debian 12 from ${mirror:-deb.debian.org} ..."
debootstrap --variant=minbase bookworm "$bare" "${mirror:-http://deb.debian.org/debian}" >"$bare.log" 2>&1 ||
  fail "$(tail -n 5 "$bare.log")"
# Uses the package sources, keys and proxies of this machine.
rm -rf "$bare/etc/apt"
cp -r /etc/apt "$bare/etc/apt"
if [[ -d /usr/share/keyrings ]]; then cp -rn /usr/share/keyrings "$bare/usr/share/"; fi
if [[ -d /etc/ssl/certs ]]; then mkdir -p "$bare/etc/ssl" && cp -r /etc/ssl/certs "$bare/etc/ssl/"; fi
cp /etc/resolv.conf "$bare/etc/resolv.conf"
mount -t proc proc "$bare/proc"

# inside <script>: runs it there as root.
inside() { chroot "$bare" env -i HOME=/root LC_ALL=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin bash -euc "$1"; }
