// A campaign: what was tested on a rig, how, which scenes stand for it, what to fit and which
// published or earlier results to compare with. One TOML file; paths in it are relative to it.
//
//   title = "..."        source = "..."        description = "..."
//   [report]             author, organisation, client, project, date, revision, logo:
//   report_details.h [strand]             youngs_modulus (Pa), wires, wire_diameter, diameter (m):
//   bounds on EI
//   [[scene]]            name, file; tables published / inferred / assumed: parameter = how known
//   [[test]]             name, kind, title, and by kind:
//     kind = "bending"   span (m), and a [test.table] with columns tension, EI, or recordings:
//                        span_std (m), tension_zero_std (N), tension_calibration_std,
//                        load_calibration_std, deflection_calibration_std (relative),
//                        clamp_stiffness (N m/rad; 1 over the std of a clamp's flexibility),
//                        channels = { tension, load, deflection } (default: as
//                        `rigfit bending` finds them); a table may hold several tensions;
//                        tension = 0: a beam without tension, by dead weights or a testing
//                        machine, with ends ("clamped", "pinned", "cantilever"), and for its
//                        modulus rectangle = [width, height], diameter (m) or second_moment (m4)
//                        with section_std (relative)
//     kind = "axial"     mass (kg, hung), mass_std, mass_per_length (kg/m), mass_per_length_std,
//                        length_std (m), adapter_stiffness (N/m), adapter_stiffness_std,
//                        frame_stiffness (N/m, or "rigid"), frame_stiffness_std,
//                        compliance_std (m/N, of what else gives way in series; 0: rigid),
//                        catalogue_EA (N), channel, band = [LO, HI] (Hz); recordings with length
//     kind = "decay"     free decays: channels (default: all), band; with scene, tension_of, EI_of,
//                        EA_of, damping_of (parameters that take the axial test's damping ratio),
//                        load: the scene's release or impact is simulated and laid over them
//     kind = "modal"     recordings of hammer hits alone, or with scene, planes, tension_of,
//                        EI_of, EA_of, damping_of: one or both of
//                        a [test.table] with columns tension (none: one state), measured,
//                        models = { label = column, ... }; and recordings of hammer hits: force
//                        (channel), responses (default: every other), sensors = { channel =
//                        the scene's sensor } where names differ, load (the scene's, that was
//                        struck), direction ([x, y, z], struck and measured along it), band,
//                        estimator ("h1", "h2", "hv"), force_window (s after the pulse begins),
//                        exponential_window (level at the end of the block), max_order
//     kind = "tension"   length (m), length_std, mass_per_length (kg/m), mass_per_length_std,
//     mass_of
//                        ("installed", "unstretched"), EI (N m2), EI_std, EA (N), EA_std (none:
//                        fitted, or a strain of 0.001), inclination (degrees), ends ("compare",
//                        "pinned", "clamped", "springs"), plane ("in", "out", "any"), missed,
//                        false (probabilities of a mode not seen, of a false one); one or more of
//                        frequencies (Hz) with frequency_std (Hz), measured (a table of modes, or
//                        UFF 55) with column, and recordings of its motion: channels, band,
//                        max_peaks (a channel)
//     [test.reference]   tension (N) of a tension test, EA, damping_ratio of an axial test as known
//     otherwise, and what they are:
//                        name = "published" (default), "truth", ...
//     [[test.recording]] see recording_group.h
//   [[fit]]              name, title, tests = [modal tests], hold_out, model_std, starts,
//                        reference_name ("earlier value"), predicts = [decay tests that it has not
//                        seen and is laid over], and
//     [[fit.parameter]]  name, of = [scene parameters that share the value], factors, per_state,
//                        start, prior, prior_std or prior_std_percent (of each state's own value),
//                        low, high, reference (an earlier value)
//
// Every key is checked like a scene's; the scenes and tables it names are read and checked too.
#pragma once

#include <filesystem>
#include <string_view>

#include "apps/campaign_file/campaign_types.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// Throws model::SceneError.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);
/// The same from text; `path` is named in messages, and what the text names lies beside it.
[[nodiscard]] Campaign parse_campaign(std::string_view text, const std::filesystem::path& path);

}  // namespace rigfit::apps
