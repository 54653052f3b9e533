-- A depth, a batch and an error through libpdepth from LuaJIT: client.lua FOLDER pdepth.h libpdepth.so
local folder, header, library = ...
package.path = folder .. "/?.lua;" .. package.path
local ffi = require("ffi")
local pd = require("pdepth")(header, library)

-- A struct of zeros that knows its size.
local function new(name)
  local struct = ffi.new(name)
  struct.size = ffi.sizeof(name)
  return struct
end

local context = ffi.new("pdepth_context*[1]")
assert(pd.pdepth_context_create(nil, context) == pd.PDEPTH_OK)
context = ffi.gc(context[0], pd.pdepth_context_destroy)

local function error_of(status)
  local err = ffi.new("pdepth_error")
  pd.pdepth_last_error(context, err)
  return string.format("%s: %s (%s)", ffi.string(pd.pdepth_status_name(status)), ffi.string(err.message),
                       ffi.string(err.where))
end

local function require_ok(status)
  if status ~= pd.PDEPTH_OK then error(error_of(status)) end
end

local shapes = ffi.new("pdepth_shape*[1]")
require_ok(pd.pdepth_box(context, ffi.new("double[3]", 0.5, 0.5, 0.5), shapes))
local cube = ffi.gc(shapes[0], pd.pdepth_shape_release)

-- One pair: the cubes overlap by a quarter.
local question, answer = new("pdepth_question"), new("pdepth_answer")
question.a, question.b = cube, cube
question.pose_b.numbers[0] = 0.75
require_ok(pd.pdepth_depth(context, question, answer))
local way = answer.translation
print(string.format("depth %g, A moves by %g %g %g", answer.depth, way[0], way[1], way[2]))

-- A thousand places of B on two threads.
local positions, answers = ffi.new("double[1000][3]"), ffi.new("pdepth_answer[1000]")
for i = 0, 999 do positions[i][0] = i / 128 end
answers[0].size = ffi.sizeof("pdepth_answer")
local bodies = ffi.new("const pdepth_shape*[1]", cube)
local batch = new("pdepth_batch")
batch.threads, batch.count, batch.a, batch.b = 2, 1000, bodies, bodies
batch.poses_b.numbers, batch.poses_b.stride = positions[0], 24
require_ok(pd.pdepth_depth_batch(context, batch, answers, ffi.sizeof("pdepth_answer")))
local counts = {[0] = 0, 0, 0}
for i = 0, 999 do counts[answers[i].contact] = counts[answers[i].contact] + 1 end
print(string.format("1000 places: %d overlap, %d touch", counts[pd.PDEPTH_OVERLAPPING], counts[pd.PDEPTH_TOUCHING]))

-- Bad input is a named error.
print(error_of(pd.pdepth_box(context, ffi.new("double[3]", 0.5, -0.5, 0.5), shapes)))
