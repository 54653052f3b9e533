-- pdepth.h for LuaJIT: the header itself, without the lines of the preprocessor and of C++.
local ffi = require("ffi")

return function(header, library)
  local file = assert(io.open(header))
  local text = ("\n" .. file:read("*a")):gsub("#ifdef __cplusplus.-#endif", ""):gsub("\n#[^\n]*", "")
  file:close()
  ffi.cdef(text)
  return ffi.load(library)
end
