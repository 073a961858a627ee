//! The charts and the report: well formed, deterministic, safe against any input.

use crate::charts;
use crate::well_formed::assert_well_formed;
use fga_report::interval::Estimate;
use fga_report::plot::{
    Axis, BoxChart, Cdf, Histogram, LineChart, LinePoint, PlotLine, SampleSeries,
};
use fga_report::report::{Cell, Column, ReportPage, Section, SectionBlock, Table};

#[test]
fn every_chart_is_well_formed_and_the_same_twice() {
    let again = charts::all();
    for ((name, svg), (_, twin)) in charts::all().into_iter().zip(again) {
        assert_well_formed(name, &svg);
        assert_eq!(svg, twin, "{name}");
    }
}

#[test]
fn a_percent_axis_reaches_from_nothing_to_all() {
    let (_, svg) = charts::all().swap_remove(0);
    for mark in [">0<", ">100<", ">separated (%)<", ">paper: about 95 %<"] {
        assert!(svg.contains(mark), "{mark}");
    }
}

#[test]
fn a_chart_without_usable_data_says_so() {
    let series = vec![SampleSeries {
        name: "lost".into(),
        values: vec![f64::NAN, f64::INFINITY],
    }];
    let cdf = Cdf {
        title: "t".into(),
        x: Axis::linear("x (m)"),
        series: series.clone(),
        limits: vec![(f64::NAN, "nowhere".into())],
    };
    let histogram = Histogram {
        title: "t".into(),
        x: Axis::log("x (m)"),
        bins: 0,
        series,
        limits: Vec::new(),
    };
    let boxes = BoxChart {
        title: "t".into(),
        x: Axis::log("x (µs)"),
        rows: Vec::new(),
        limits: Vec::new(),
    };
    for svg in [cdf.to_svg(), histogram.to_svg(), boxes.to_svg()] {
        assert_well_formed("empty", &svg);
        assert!(svg.contains("no data"));
    }
}

#[test]
fn values_that_are_not_finite_leave_a_gap() {
    let point = |x: f64, y: f64| LinePoint {
        x,
        y: Estimate::exact(y),
    };
    let svg = LineChart {
        title: "t".into(),
        x: Axis::linear("x"),
        y: Axis::log("y"),
        lines: vec![PlotLine {
            name: "<b>".into(),
            points: vec![
                point(0.0, 1.0),
                point(1.0, f64::NAN),
                point(2.0, -1.0),
                point(3.0, 10.0),
            ],
        }],
        claims: Vec::new(),
    }
    .to_svg();
    assert_well_formed("gaps", &svg);
    assert!(svg.contains("&lt;b&gt;"));
}

#[test]
fn the_report_is_one_file_without_network_or_script() {
    let page = charts::report().to_html();
    assert_well_formed("report", &page);
    for absent in ["<script", "http-equiv", "src=", "@import", "url("] {
        assert!(!page.contains(absent), "{absent}");
    }
    // The only address in the page names the namespace of SVG.
    let addresses = page.matches("http").count();
    assert_eq!(
        addresses,
        page.matches("http://www.w3.org/2000/svg").count()
    );
    assert!(page.contains("5b6e0c8d &lt;&amp;&gt;"));
}

#[test]
fn tables_show_shares_in_per_cent_with_their_interval() {
    let mut report = ReportPage::new("<i>");
    report.sections.push(Section {
        title: "one".into(),
        blocks: vec![SectionBlock::Table(Table {
            caption: String::new(),
            columns: vec![Column::text("a"), Column::number("b"), Column::number("c")],
            rows: vec![vec![
                Cell::Text("<script>".into()),
                Cell::Share(Estimate::wilson(8, 10).expect("ten trials")),
            ]],
        })],
    });
    let page = report.to_html();
    assert_well_formed("table", &page);
    assert!(page.contains("80.0 <small>[49.0, 94.3]</small>"));
    assert!(page.contains("&lt;script&gt;"));
}
