// How the pieces of a report, and what its parts hand on to each other, are kept between runs
// (archive.h).
#pragma once

#include "apps/report/archive.h"
#include "apps/report/report_part.h"
#include "signal/modal/modal_model.h"
#include "signal/numerics/estimate.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

template <class A>
void archive(A& a, Estimate& v) {
  a(v.value, v.std);
}
template <class A>
void archive(A& a, Note& v) {
  a(v.code, v.message, v.where);
}
template <class A>
void archive(A& a, MeasuredPoint& v) {
  a(v.name, v.node, v.direction);
}
template <class A>
void archive(A& a, FrfSet& v) {
  a(v.frequency_hz, v.responses, v.inputs, v.H, v.H_std, v.coherence, v.form, v.unit,
    v.exponential_decay_rate_1_s, v.averages, v.sample_rate_hz, v.notes);
}
template <class A>
void archive(A& a, IdentifiedMode& v) {
  a(v.frequency_hz, v.damping_ratio, v.damping_ratio_with_window, v.pole_rad_s, v.shape,
    v.shape_std, v.participation, v.modal_phase_collinearity, v.reconstruction_error, v.presence,
    v.significance, v.damping_dominated_by_window, v.doubtful, v.doubt);
}
template <class A>
void archive(A& a, ModalModel& v) {
  a(v.modes, v.responses, v.inputs, v.lower_residual, v.upper_residual, v.frf_error, v.fitted_form,
    v.exponential_decay_rate_1_s, v.pole_covariance, v.notes);
}

}  // namespace rigfit::signal

namespace rigfit::apps {

template <class A>
void archive(A& a, PlotSeries& v) {
  a(v.name, v.origin, v.style, v.x, v.y, v.low, v.high, v.variant, v.group);
}
template <class A>
void archive(A& a, Plot& v) {
  a(v.id, v.title, v.caption, v.x_label, v.y_label, v.log_x, v.log_y, v.series);
}
template <class A>
void archive(A& a, Paragraph& v) {
  a(v.text, v.kind);
}
template <class A>
void archive(A& a, Cell& v) {
  a(v.text, v.origin, v.doubtful, v.shade);
}
template <class A>
void archive(A& a, Column& v) {
  a(v.name, v.origin, v.numeric);
}
template <class A>
void archive(A& a, ReportTable& v) {
  a(v.id, v.caption, v.columns, v.rows, v.fold);
}
template <class A>
void archive(A& a, PlotTab& v) {
  a(v.label, v.plots);
}
template <class A>
void archive(A& a, PlotGroup& v) {
  a(v.id, v.title, v.tabs);
}
template <class A>
void archive(A& a, ShapeViewer& v) {
  a(v.id, v.caption, v.states);
}
template <class A>
void archive(A& a, SummaryItem& v) {
  a(v.kind, v.label, v.text, v.origin, v.anchor);
}
template <class A>
void archive(A& a, PartWarning& v) {
  a(v.code, v.message, v.where, v.refused);
}
template <class A>
void archive(A& a, OutputFile& v) {
  a(v.path, v.content);
}
template <class A>
void archive(A& a, ModelCost& v) {
  a(v.what, v.method, v.choices, v.wall_s, v.relative_error);
}
template <class A>
void archive(A& a, ReportPart& v) {
  a(v.id, v.title, v.blocks, v.summary, v.warnings, v.files, v.costs, v.inputs, v.json, v.json_key);
}

}  // namespace rigfit::apps
