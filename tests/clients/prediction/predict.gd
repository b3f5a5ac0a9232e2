# Runs the addon's predictor (test_prediction.py): WHOLEHAND_JOB names the job, WHOLEHAND_ANSWER the file to write.
extends SceneTree

const MotionPredictor = preload("res://addons/wholehand/motion_predictor.gd")
const State = preload("res://addons/wholehand/state.gd")


func _init():
	var file = File.new()
	file.open(OS.get_environment("WHOLEHAND_JOB"), File.READ)
	var job = parse_json(file.get_as_text())
	file.close()
	var answers = []
	for run in job.runs:
		answers.append(_answer(run))
	file.open(OS.get_environment("WHOLEHAND_ANSWER"), File.WRITE)
	file.store_string(to_json(answers))
	file.close()
	quit()


func _answer(frames):
	var motion = MotionPredictor.new()
	var answers = []
	for frame in frames:
		for reported in frame.states:
			var state = State.new()
			state.session = 1
			state.time_s = reported[0]
			state.sent_monotonic_ns = int(reported[1])
			state.theta = PoolRealArray(reported[3])
			motion.add(state, int(reported[2]))
		answers.append(Array(motion.joints(int(frame.at_ns))))
	return answers
