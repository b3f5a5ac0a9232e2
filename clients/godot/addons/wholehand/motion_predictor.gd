# Predicts the hand's joints at present from states that come late, irregularly and with losses: a parabola through the
# newest state and two earlier ones. Its curvature is weighted by three quarters, which halves the overshoot at the end
# of a motion. The age of a state is relative to the fastest delivery of the last seconds: the clocks of program and
# client may differ, and the delay of the fastest delivery is not compensated.
extends Reference

const SPACING_S = 0.0045      # minimum spacing between the states of a parabola
const CURVATURE_SHARE = 0.75
const LONGEST_S = 0.05        # maximum extrapolation beyond the newest state
const FADES_FROM_S = 0.1      # without a new state the hand returns to the newest one from this age,
const FADED_AT_S = 0.25       # until this age
const DELAY_WINDOW_NS = 2000000000 # the minimum delay is taken over one to two windows
const KEPT = 4

var _kept = [] # [time_s, joints], newest first; each other one is at least SPACING_S older
var _session = 0
var _newest_sent_ns = 0
var _delay_ns = 0
var _delay_before_ns = 0
var _window_ends_ns = 0


# Clears all states for another connection, whose program may have another clock.
func clear() -> void:
	_kept = []


# Adds a state of state.gd with its time of arrival, 1000 * OS.get_ticks_usec(). Older states are ignored.
func add(state, received_ns: int) -> void:
	var same = not _kept.empty() and state.session == _session and state.theta.size() == _kept[0][1].size()
	if state.theta.size() == 0 or same and (state.sent_monotonic_ns <= _newest_sent_ns or state.time_s == _kept[0][0]):
		return
	var continues = same and state.time_s > _kept[0][0]
	_count_delay(received_ns - state.sent_monotonic_ns, received_ns)
	if not continues:
		_kept = []
	_session = state.session
	_newest_sent_ns = state.sent_monotonic_ns
	# The newest sample is kept if it is far enough from the next one; otherwise it is replaced.
	if _kept.size() > 1 and _kept[0][0] - _kept[1][0] < SPACING_S:
		_kept.pop_front()
	_kept.push_front([state.time_s, state.theta])
	if _kept.size() > KEPT:
		_kept.pop_back()


# The joints at a time of the same clock; empty before the first state.
func joints(now_ns: int) -> PoolRealArray:
	if _kept.empty():
		return PoolRealArray()
	var newest = _kept[0][1]
	var age_s = max(0.0, 1e-9 * (now_ns - _newest_sent_ns - int(min(_delay_ns, _delay_before_ns))))
	var fading = clamp((FADED_AT_S - age_s) / (FADED_AT_S - FADES_FROM_S), 0.0, 1.0)
	var ahead_s = fading * min(age_s, LONGEST_S)
	var one = 2 if _kept.size() > 1 and _kept[0][0] - _kept[1][0] < SPACING_S else 1
	if one >= _kept.size():
		return newest
	var before = _kept[one][1]
	var h = _kept[0][0] - _kept[one][0]
	var curved = one + 1 < _kept.size()
	var first = _kept[one + 1][1] if curved else before
	var h_before = _kept[one][0] - _kept[one + 1][0] if curved else 1.0
	var all = PoolRealArray()
	all.resize(newest.size())
	for i in range(newest.size()):
		var slope = (newest[i] - before[i]) / h
		var ahead = slope * ahead_s
		if curved:
			ahead += CURVATURE_SHARE * (slope - (before[i] - first[i]) / h_before) / (h + h_before) * ahead_s * (ahead_s + h)
		all[i] = newest[i] + ahead
	return all


# Keeps the minimum of this window and of the one before it.
func _count_delay(ns: int, now_ns: int) -> void:
	if _kept.empty():
		_delay_ns = ns
		_delay_before_ns = ns
		_window_ends_ns = now_ns + DELAY_WINDOW_NS
	if now_ns >= _window_ends_ns:
		_delay_before_ns = _delay_ns
		_delay_ns = ns
		_window_ends_ns = now_ns + DELAY_WINDOW_NS
	_delay_ns = int(min(_delay_ns, ns))
