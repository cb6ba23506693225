#include "apps/report/page/answer.h"

#include "apps/describe/json_of.h"
#include "apps/report/campaign_report.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/report_page.h"
#include "tests/test.h"

namespace rigfit::apps::answer_test {

Answer stiffness(double value, double std) {
  Answer answer{.key = "fit/beam.EI_z",
                .quantity = "Beam bending stiffness EI_z",
                .how = "fitted to 5 modes",
                .unit = "N m²",
                .value = value,
                .std = std,
                .low = value - 1.96 * std,
                .high = value + 1.96 * std};
  return answer;
}

TEST(Answer, VerdictsSayHowWellAValueIsKnownAndWhetherItAgrees) {
  Answer answer = stiffness(2.17, 0.0045);
  EXPECT_EQ(verdict_words(answer), "well known, within 0.4 %");
  EXPECT_FALSE(doubtful(answer));
  answer.reference = 2.30;
  answer.reference_name = "published";
  EXPECT_EQ(verdict_words(answer),
            "well known, within 0.4 %; published 2.300: outside the interval");
  EXPECT_TRUE(doubtful(answer));
  EXPECT_EQ(verdict_words(stiffness(2, 0.3)), "roughly known, within 29 %");
  EXPECT_EQ(verdict_words(stiffness(2, 1.5)), "poorly determined");
  EXPECT_TRUE(doubtful(stiffness(2, 1.5)));
  answer.determined = false;
  EXPECT_EQ(verdict_words(answer), "not identifiable from these data");
  EXPECT_EQ(value_words(answer), "not determined");
  EXPECT_EQ(verdict_words(stiffness(2, Answer::kNone)), "uncertainty not known");
}

ComparedReport report_of(const std::vector<Answer>& answers) {
  static const Campaign campaign{.file = "campaign.toml", .title = "title"};
  return {campaign, answers};
}

// Differences of 1, 2.5 and 8 standard uncertainties of the difference; a mode that is not there
// any more; the two modes of one state are paired by nearness, not by row.
TEST(CompareReports, SayWhatChangedBeyondItsUncertainty) {
  const auto mode = [](double hz) {
    Answer answer{.key = "beam/as built/frequency",
                  .quantity = "natural frequency",
                  .unit = "Hz",
                  .value = hz,
                  .std = 0.01};
    return answer;
  };
  const double step = std::hypot(0.3, 0.4);
  Answer second = stiffness(100, 0.3), third = stiffness(100, 0.3);
  second.key = "b";
  third.key = "c";
  Answer second_after = stiffness(100 + 2.5 * step, 0.4),
         third_after = stiffness(100 + 8 * step, 0.4);
  second_after.key = "b";
  third_after.key = "c";
  const auto part = compare_reports(
      report_of({stiffness(100, 0.3), second, third, mode(10), mode(20), mode(50)}),
      report_of({stiffness(100 + step, 0.4), second_after, third_after, mode(20.001), mode(10.5)}));
  ASSERT_EQ(part.json.size(), 6u);
  EXPECT_EQ(part.json[0]["verdict"], "no change beyond its uncertainty");
  EXPECT_EQ(part.json[1]["verdict"], "perhaps changed");
  EXPECT_EQ(part.json[2]["verdict"], "changed");
  EXPECT_NEAR(part.json[2]["change_std"].get<double>(), step, 1e-12);
  EXPECT_EQ(part.json[3]["after"]["value"], 10.5);
  EXPECT_TRUE(part.json[3]["changed"].get<bool>());
  EXPECT_EQ(part.json[4]["after"]["value"], 20.001);
  EXPECT_EQ(part.json[5]["verdict"], "only before");
}

// Damping belongs to its mode: that of a mode at 20 Hz, found in another place of the list, is not
// compared with the nearer value of the mode at 10 Hz.
TEST(CompareReports, PairDampingByTheFrequencyOfItsMode) {
  const auto damping = [](double hz, double value) {
    Answer answer{.key = "beam/as built/damping",
                  .quantity = "damping ratio 1",
                  .value = value,
                  .std = 1e-5,
                  .mode_hz = hz};
    return answer;
  };
  const auto part = compare_reports(report_of({damping(10, 0.010), damping(20, 0.012)}),
                                    report_of({damping(20.1, 0.010), damping(10.1, 0.012)}));
  ASSERT_EQ(part.json.size(), 2u);
  EXPECT_EQ(part.json[0]["before"]["value"], 0.010);
  EXPECT_EQ(part.json[0]["after"]["value"], 0.012);
  EXPECT_THAT(part.json[0]["quantity"].get<std::string>(), HasSubstr("mode near 10"));
  EXPECT_TRUE(part.json[0]["changed"].get<bool>());
}

// The better known one of two values of a member's stiffness is recommended, whatever it was
// measured in; a mass belongs to its structure, and says so. A contradiction is a verdict.
TEST(Answer, OneValueAQuantityIsRecommended) {
  Answer a = stiffness(2.17, 0.005), b = stiffness(2.30, 0.004), m = stiffness(0.023, 0.001);
  a.structure = "beam", b.structure = "rig";
  m.quantity = "Tip mass";
  m.of_structure = true;
  m.structure = "beam";
  Answer n = m;
  n.structure = "rig";
  n.std = 0.03;
  std::vector<Answer*> all{&a, &b, &m, &n};
  recommend(all);
  EXPECT_FALSE(a.recommended);
  EXPECT_TRUE(b.recommended);
  EXPECT_TRUE(doubtful(b));
  EXPECT_TRUE(m.recommended && n.recommended);
  EXPECT_EQ(quantity_words(n), "Tip mass, rig");
}

// One of each kind with its places, refusals first and each by itself, notes last.
TEST(Findings, AreSortedAndSaidOnce) {
  std::vector<ReportPart> parts(1);
  parts[0].warnings = {{"start_chosen", "starts at 7", "a", false},
                       {"one_length", "Give more segments: 0.10 %", "b", false},
                       {"one_length", "Give more segments: 0.25 %", "c", false},
                       {"unpaired", "Check these", "d", false},
                       {"recording", "cannot be read", "e", true},
                       {"recording", "cannot be read", "f", true}};
  const auto list = findings_of(parts);
  ASSERT_EQ(list.size(), 5u);
  EXPECT_EQ(list[0].listed(), "e");
  EXPECT_EQ(list[1].listed(), "f");
  EXPECT_EQ(list[2].first.code, "unpaired");
  EXPECT_EQ(list[3].listed(), "b; c");
  EXPECT_EQ(list[3].first.message, "Give more segments: 0.10 %");
  EXPECT_TRUE(list[4].note());
  EXPECT_FALSE(list[3].note());
}

TEST(HtmlText, EscapesMarkupAndMendsBytes) {
  EXPECT_EQ(escaped("a<b>&\"c\" 'd'"), "a&lt;b&gt;&amp;&quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escaped("N m\xc2\xb2"), "N m\xc2\xb2");
  EXPECT_EQ(escaped("\xb5m"), "µm");                       // Windows-1252
  EXPECT_EQ(escaped(std::string("a\x01z\0", 4)), "a z ");  // control characters
}

TEST(HtmlText, ShowsNumbersWithTheirDigits) {
  EXPECT_EQ(shown(0.25494, 4), "0.2549");
  EXPECT_EQ(shown(-15.5632, 3), "−15.6");
  EXPECT_EQ(shown(221780, 3), "221780");
  EXPECT_EQ(shown(1.5e-6, 2), "1.5e-06");
  EXPECT_EQ(shown(NAN), "–");
  EXPECT_EQ(shown(0), "0");
  EXPECT_EQ(shown_percent(0.01234), "+1.23 %");
  EXPECT_EQ(shown_percent(-0.139), "−13.9 %");
  EXPECT_EQ(shown_percent(1e-9), "0.00 %");
  // The std is never raised to the digits of the value.
  EXPECT_EQ(within_percent(6e-7), "less than 0.001 %");
  EXPECT_EQ(within_percent(0.0041), "0.4 %");
  EXPECT_EQ(within_percent(0.12), "12 %");
}

}  // namespace rigfit::apps::answer_test
