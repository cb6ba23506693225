// Modes from motion under unknown, ambient forces (wind, traffic, sea), with intervals; several
// set-ups of sensors joined by reference channels.
//
// What the data can tell of a mode is a matter of one number: T / tau, the length of the recording
// over the mode's decay time tau = 1 / (zeta omega). At best std(zeta) / zeta = (T / tau)^-1/2 and
// std(f) / f = zeta (T / tau)^-1/2 (Cramer-Rao bound of a long recording without noise). Below 40
// decay times no interval is vouched for.
//
// Way: 1. steady tones are found, fitted and taken out. 2. Correlations of 24 groups of the
// recording with an exponential lag window, whose decay is taken off the poles exactly; half
// spectra of them give candidates by poly-reference LSCF over all orders. 3. For every mode a
// linear combination of the channels that passes it with gain 1, suppresses its neighbours and has
// the least power otherwise in the mode's band: its auto-spectrum is one resonance, whatever the
// correlation of the forces. 4. Poles common to these spectra by Whittle's weights, residues
// eliminated (ambient_steps.h). 5. Shapes: residues of all channels' half spectra with the filtered
// signals. 6. Uncertainty: jackknife over the groups, joined until they hold five decay times; the
// degrees of freedom are those of the energy in the groups (gusts leave fewer), the intervals
// Student's. Forces need to be white in a mode's band only.
//
// Sources: Brincker and Ventura, Introduction to Operational Modal Analysis (2015); Peeters and Van
// der Auweraer, IOMAC 2005 (half spectra); Au, Mech. Syst. Signal Process. 48 (2014) 15 (bounds);
// Efron, The Jackknife (1982); Satterthwaite, Biometrics Bulletin 2 (1946) 110.
#pragma once

#include "signal/ambient/ambient_result.h"

namespace rigfit::signal {

/// Modes of one set-up. Throws RecordingError as channel_index(), without a constant sample rate,
/// for constant or mostly missing channels, and when the band or the recording holds too little.
/// No mode: an empty list and a note.
[[nodiscard]] AmbientResult ambient_modes(const Recording& recording,
                                          const AmbientOptions& options = {});

/// One result for several set-ups, whose references have the same names. Modes without doubts are
/// matched by frequency and by the shape of the references; frequency and log damping are means
/// over set-ups where they agree, else random effects (groups.h) and a note "groups_differ". Shapes
/// are scaled by the references in the least-squares sense. A note "gain_changed" names a reference
/// whose ratio to the first one changed alike in all modes, "setup_lacks_mode" a mode that is not
/// matched in all set-ups; where one of these alone has a channel, the mode's shape is empty.
/// Throws RecordingError when a reference is missing in a set-up.
[[nodiscard]] AmbientResult merge_setups(std::span<const AmbientResult> setups,
                                         std::vector<std::string> references = {});

}  // namespace rigfit::signal
