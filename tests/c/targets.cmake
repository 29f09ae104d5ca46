# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# cmake -D compiler=… -D include=… -P targets.cmake: the headers are refused, by a sentence, for processors
# on which samples would have other bits, and taken where they have not. The preprocessor alone decides, so
# that no such machine is needed; the compiler is one for x86-64.
function(preprocess result said)
  execute_process(COMMAND ${compiler} -E -ffreestanding -I ${include} ${ARGN} -include sunfleck/base.h -x c /dev/null
                  RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE text)
  set(${result} ${code} PARENT_SCOPE)
  set(${said} "${text}" PARENT_SCOPE)
endfunction()

function(expect_refused part)
  preprocess(code text ${ARGN})
  if(code EQUAL 0 OR NOT text MATCHES "${part}")
    message(FATAL_ERROR "${ARGN}: ${code}, where '${part}' should be said: ${text}")
  endif()
endfunction()

function(expect_taken)
  preprocess(code text ${ARGN})
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${code}, ${text}")
  endif()
endfunction()

expect_taken()
expect_taken(-m32 -msse2 -mfpmath=sse)
expect_refused("computed as floats" -m32 -mno-sse)
expect_refused("computed as floats" -U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=2) # by -mfpmath=387, where GCC knows it
expect_refused("big-endian" -U__BYTE_ORDER__ -D__BYTE_ORDER__=4321)
