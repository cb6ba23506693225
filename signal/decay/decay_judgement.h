// Whether a decay's numbers can be given, and what a person should know before using them.
#pragma once

#include <string>

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Ends `result` without an answer: a stable code, and what is wrong and would help.
void refuse(DecayResult& result, std::string code, std::string message);
/// Something to know beside the answer.
void note(DecayResult& result, std::string code, std::string message);

/// Refuses what the fit does not determine: too little energy (`too_noisy`), nothing that decays
/// (`nothing_decays`), a motion that something drives (`driven`), too few cycles or two modes that
/// are one (`not_determined`). Notes where one number does not say it all.
void judge_decay(DecayResult& result, const DampedSinusoidsFit& fit, double sample_rate_hz,
                 double false_alarm);

}  // namespace rigfit::signal
