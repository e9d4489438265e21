// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/processor.hpp"

namespace impactrig::models {
namespace {

Processor find_processor() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return Processor::any;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return Processor::avx512;
  return Processor::avx2;
#else
  return Processor::any;
#endif
}

}  // namespace

Processor processor() {
  static const Processor found = find_processor();
  return found;
}

}  // namespace impactrig::models
