// What a person should know before using a decay's numbers, and whether they can be given at all.
#pragma once

#include <string>

#include "signal/decay/decay_result.h"

namespace rigfit::signal {

/// Ends `result` without an answer: a stable code, and what is wrong and would help.
void refuse(DecayResult& result, std::string code, std::string message);
/// Something to know beside the answer.
void note(DecayResult& result, std::string code, std::string message);

/// Refuses what is not determined, and notes where the numbers lean on little: short or noisy
/// records, damping that depends on amplitude, residuals that are no noise.
void judge_decay(DecayResult& result, double sample_rate_hz);

}  // namespace rigfit::signal
