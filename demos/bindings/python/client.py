"""A depth, a batch and an error through libpdepth from Python by ctypes: `client.py libpdepth.so`."""
import ctypes as c
import sys

import pdepth_c as pd

library = pd.load(sys.argv[1])
context = pd.Context()
if library.pdepth_context_create(None, c.byref(context)) != pd.OK:
    sys.exit("no context")


def error_of(status):
    error = pd.Error()
    library.pdepth_last_error(context, c.byref(error))
    return f"{library.pdepth_status_name(status).decode()}: {error.message.decode()} ({error.where.decode()})"


def require(status):
    if status != pd.OK:
        sys.exit(error_of(status))


cube = pd.Shape()
require(library.pdepth_box(context, pd.Double3(0.5, 0.5, 0.5), c.byref(cube)))

# One pair: the cubes overlap by a quarter.
question, answer = pd.Question(a=cube, b=cube), pd.Answer()
question.pose_b.numbers[0] = 0.75
require(library.pdepth_depth(context, c.byref(question), c.byref(answer)))
print(f"depth {answer.depth:g}, A moves by {' '.join(f'{x:g}' for x in answer.translation)}")

# A thousand places of B on two threads.
rows = 1000
positions = (pd.Double3 * rows)(*(pd.Double3(i / 128, 0, 0) for i in range(rows)))
answers = (pd.Answer * rows)()
answers[0].size = c.sizeof(pd.Answer)
batch = pd.Batch(threads=2, count=rows, a=c.pointer(cube), b=c.pointer(cube))
batch.poses_b.numbers, batch.poses_b.stride = c.addressof(positions), c.sizeof(pd.Double3)
require(library.pdepth_depth_batch(context, c.byref(batch), answers, c.sizeof(pd.Answer)))
contacts = [answer.contact for answer in answers]
print(f"{rows} places: {contacts.count(pd.OVERLAPPING)} overlap, {contacts.count(pd.TOUCHING)} touch")

# Bad input is a named error.
none = pd.Shape()
print(error_of(library.pdepth_box(context, pd.Double3(0.5, -0.5, 0.5), c.byref(none))))

library.pdepth_shape_release(cube)
library.pdepth_context_destroy(context)
