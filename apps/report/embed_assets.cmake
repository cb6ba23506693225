# Writes a C++ source with the given files as byte strings: cmake -DOUTPUT=x.cc -DFILES=a;b -DNAMES=a;b -P
# The page of a report carries its style sheet and scripts in itself, so they are part of the program.
set(text "#include \"apps/cli/assets.h\"\n\nnamespace rigfit::apps::assets {\n")
list(LENGTH FILES count)
math(EXPR last "${count} - 1")
foreach(i RANGE ${last})
  list(GET FILES ${i} file)
  list(GET NAMES ${i} name)
  file(READ "${file}" hex HEX)
  # Twenty bytes a line, so that no line is absurdly long.
  string(REPEAT "." 40 line)
  string(REGEX REPLACE "(${line})" "\\1\n" bytes "${hex}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
  string(REPLACE "\n" "\"\n\"" bytes "${bytes}")
  file(SIZE "${file}" size)
  string(APPEND text "const std::string_view ${name}(\n\"${bytes}\", ${size});\n")
endforeach()
string(APPEND text "}  // namespace rigfit::apps::assets\n")
file(WRITE "${OUTPUT}" "${text}")
