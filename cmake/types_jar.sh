#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# types_jar.sh LCM_GEN JAVAC JAR OUT.jar FILE.lcm ...
set -e
lcm_gen=$1 javac=$2 jar=$3 out=$4
shift 4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/src" "$work/classes"
"$lcm_gen" -j --jpath "$work/src" "$@"
find "$work/src" -name '*.java' -exec "$javac" -nowarn -d "$work/classes" -cp /usr/share/java/lcm.jar {} +
"$jar" cf "$out" -C "$work/classes" .
