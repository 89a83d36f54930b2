//! The pages of the first start: the source, the hand, the layout, and the start. They ask and propose what `ademan start` does.

mod search;

use std::sync::LazyLock;

use ademan_core::document::{Document, shipped_layouts};
use ademan_core::hand::Side;
use ademan_core::layout::Layout;
use ademan_runtime::capture::SourceUri;
use ademan_runtime::setup::{LoadedSetup, MirroredLayout, Setup, SetupError};

pub use self::search::{Port, Search};

/// A page. Each has a proposal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Page {
    /// The sources that were found.
    #[default]
    Source,
    /// The hand that is measured.
    Hand,
    /// The layout.
    Layout,
    /// A summary, and the start.
    Start,
}

impl Page {
    /// The pages, in order.
    pub const ALL: [Self; 4] = [Self::Source, Self::Hand, Self::Layout, Self::Start];
}

/// A layout that comes with the program.
pub struct LayoutChoice {
    /// Name.
    pub name: String,
    /// Description in one line.
    pub description: String,
}

/// The layouts that come with the program.
pub static LAYOUTS: LazyLock<Vec<LayoutChoice>> = LazyLock::new(|| {
    let choice = |name: &str| {
        let layout = Document::shipped(name)
            .and_then(Layout::from_document)
            .ok()?;
        Some(LayoutChoice {
            name: name.to_owned(),
            description: layout.description,
        })
    };
    shipped_layouts().filter_map(choice).collect()
});

/// The layout that is proposed for a source and a hand.
struct Proposal {
    /// The source and the hand.
    of: Setup,
    name: String,
    mirrored: Option<MirroredLayout>,
}

impl Proposal {
    fn new(of: Setup) -> Result<Self, SetupError> {
        // Nothing is written for the simulated hand.
        let mirrored = match &of.source {
            Some(_) => of.mirrored_layout()?,
            None => None,
        };
        let name = match &mirrored {
            Some(mirrored) => mirrored.name(),
            None => of.proposed_layout()?.to_owned(),
        };
        Ok(Self { of, name, mirrored })
    }
}

/// The answers of the first start.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// Source, glove and layout. A setup without a source is for the simulated hand.
    pub setup: Setup,
    /// The layout, if a file of it is to be written before the session starts.
    pub mirrored: Option<MirroredLayout>,
    /// The setup is written to the configuration folder.
    pub is_kept: bool,
    /// The session starts with the calibration of the glove.
    pub is_calibrated: bool,
}

/// The first start: its present page, and the answers so far.
pub struct FirstStart {
    page: Page,
    search: Search,
    /// The chosen source, whose `None` is the simulated hand. Without an answer, it is the first one that is found.
    source: Option<Option<SourceUri>>,
    side: Side,
    /// The chosen layout.
    layout: Option<String>,
    /// The latest proposal.
    proposal: Option<Proposal>,
    is_kept: bool,
    is_calibrated: bool,
    /// Reason why the session has not started.
    pub error: Option<String>,
}

impl FirstStart {
    /// Creates the first page.
    pub fn new(search: Search) -> Self {
        Self {
            page: Page::default(),
            search,
            source: None,
            side: Side::Right,
            layout: None,
            proposal: None,
            is_kept: true,
            is_calibrated: true,
            error: None,
        }
    }

    /// Receives what the search has found since the last call. Does not wait.
    pub fn update(&mut self) {
        self.search.update();
    }

    /// Returns the search.
    pub fn search(&self) -> &Search {
        &self.search
    }

    /// Returns the present page.
    pub fn page(&self) -> Page {
        self.page
    }

    /// Goes to the page after the present one. The last one stays.
    pub fn advance(&mut self) {
        self.go(|index| index + 1);
    }

    /// Goes to the page before the present one. The first one stays.
    pub fn go_back(&mut self) {
        self.go(|index| index.saturating_sub(1));
    }

    fn go(&mut self, to: impl Fn(usize) -> usize) {
        let index = to(self.page as usize).min(Page::ALL.len() - 1);
        self.page = Page::ALL[index];
        self.error = None;
    }

    /// Discards the answer of the present page, so that its proposal applies, and continues.
    pub fn skip(&mut self) {
        match self.page {
            Page::Source => self.source = None,
            Page::Hand => self.side = Side::Right,
            Page::Layout => self.layout = None,
            Page::Start => {}
        }
        self.advance();
    }

    /// Returns the source, `None` for the simulated hand.
    pub fn source(&self) -> Option<&SourceUri> {
        match &self.source {
            Some(chosen) => chosen.as_ref(),
            None => self.search.sources().next(),
        }
    }

    /// Chooses a source, `None` for the simulated hand.
    pub fn choose_source(&mut self, source: Option<SourceUri>) {
        self.source = Some(source);
    }

    /// Returns the hand.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Chooses the hand.
    pub fn choose_side(&mut self, side: Side) {
        self.side = side;
    }

    /// Chooses a layout by its name.
    pub fn choose_layout(&mut self, name: &str) {
        // With another hand there is no layout of this name.
        let is_mirrored = self.mirrored().is_some_and(|it| it.name() == name);
        self.layout = (!is_mirrored).then(|| name.to_owned());
    }

    /// Returns the proposed layout for the source and the hand.
    pub fn proposal(&mut self) -> Result<&str, SetupError> {
        Ok(&self.find_proposal()?.name)
    }

    /// Returns the proposed layout if it is the mirror image of another one.
    pub fn mirrored(&mut self) -> Option<&MirroredLayout> {
        self.find_proposal().ok()?.mirrored.as_ref()
    }

    fn find_proposal(&mut self) -> Result<&Proposal, SetupError> {
        let setup = Setup::for_hand(self.source().cloned(), self.side, None);
        let latest = self.proposal.take().filter(|it| it.of == setup);
        let proposal = match latest {
            Some(proposal) => proposal,
            None => Proposal::new(setup)?,
        };
        Ok(self.proposal.insert(proposal))
    }

    /// Returns the layout: the chosen one, or the proposal.
    pub fn layout(&mut self) -> Result<String, SetupError> {
        match &self.layout {
            Some(name) => Ok(name.clone()),
            None => self.proposal().map(str::to_owned),
        }
    }

    /// The setup is written to the configuration folder.
    pub fn is_kept(&mut self) -> &mut bool {
        &mut self.is_kept
    }

    /// The session starts with the calibration of the glove.
    pub fn is_calibrated(&mut self) -> &mut bool {
        &mut self.is_calibrated
    }

    /// Returns `true` if the source needs a calibrated glove.
    pub fn needs_glove(&self) -> bool {
        self.source().is_some_and(SourceUri::needs_glove)
    }

    /// Returns all answers, with proposals in place of those that are missing. The setup names a mirrored layout by its name in the list.
    pub fn answers(&mut self) -> Result<Answers, SetupError> {
        let mut setup = Setup::for_hand(self.source().cloned(), self.side, None);
        setup.layout = self.layout()?;
        let mirrored = self.mirrored().filter(|it| it.name() == setup.layout);
        Ok(Answers {
            mirrored: mirrored.cloned(),
            is_kept: self.is_kept && setup.source.is_some(),
            is_calibrated: self.is_calibrated && self.needs_glove(),
            setup,
        })
    }

    /// Returns the answers that skip everything: the simulated hand on the default layout. Nothing is written.
    pub fn skipped() -> Answers {
        Answers {
            setup: Setup::default(),
            mirrored: None,
            is_kept: false,
            is_calibrated: false,
        }
    }
}

impl Answers {
    /// Loads the files of the setup for a session that types into no other program.
    pub fn load(&self) -> Result<LoadedSetup, SetupError> {
        let setup = Setup {
            output: "none".into(),
            ..self.setup.clone()
        };
        setup.load_files()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_start() -> FirstStart {
        FirstStart::new(Search::new(Vec::new(), Vec::new()))
    }

    #[test]
    fn without_a_device_each_proposal_leads_to_the_simulated_hand_and_no_file() {
        let mut first = first_start();
        let mut pages = vec![first.page()];
        while first.page() != Page::Start {
            first.skip();
            pages.push(first.page());
        }
        assert_eq!(pages, Page::ALL);
        let answers = first.answers().unwrap();
        assert_eq!(answers, FirstStart::skipped());
        assert_eq!(answers.load().unwrap().setup.output, "none");
    }

    #[test]
    fn a_glove_is_kept_and_calibrated_and_another_hand_gets_another_layout() {
        let mut first = first_start();
        first.choose_source(Some("serial:/dev/ttyUSB7".parse().unwrap()));
        assert_eq!(first.layout().unwrap(), "qwerty-flat");
        first.choose_side(Side::Left);
        let answers = first.answers().unwrap();
        assert_eq!(answers.setup.glove.as_deref(), Some("unam-hc11-left"));
        assert_eq!(answers.setup.layout, "qwerty-flat-left");
        let mirrored = answers.mirrored.expect("a new layout");
        assert_eq!(mirrored.original, "qwerty-flat");
        assert!(mirrored.text.contains("hand: \"left\""));
        assert!(answers.is_kept && answers.is_calibrated);
        first.choose_layout("qwerty-flat-left");
        first.choose_side(Side::Right);
        assert_eq!(first.layout().unwrap(), "qwerty-flat");
        first.choose_side(Side::Left);
        *first.is_kept() = false;
        first.choose_layout("numpad");
        let changed = first.answers().unwrap();
        assert!(!changed.is_kept);
        assert_eq!(changed.setup.layout, "numpad");
        assert_eq!(changed.mirrored, None);
    }

    #[test]
    fn a_skipped_page_returns_to_its_proposal() {
        let mut first = first_start();
        first.choose_source(Some("serial:/dev/ttyUSB7".parse().unwrap()));
        first.skip();
        assert_eq!(first.source(), None);
        first.choose_side(Side::Left);
        first.go_back();
        first.advance();
        assert_eq!(first.side(), Side::Left, "the answer stays");
        first.skip();
        assert_eq!(first.side(), Side::Right);
    }

    #[test]
    fn a_port_that_cannot_be_opened_is_said_with_the_reason() {
        let name = "/dev/no-such-port".to_owned();
        let mut search = Search::new(vec![name.clone()], Vec::new());
        let start = std::time::Instant::now();
        while search.is_listening() {
            assert!(start.elapsed().as_secs() < 60, "it listens on");
            search.update();
            std::thread::yield_now();
        }
        let port = &search.ports()[0];
        assert_eq!(port.name, name);
        let reason = port.heard.as_ref().unwrap().as_ref().unwrap_err();
        assert!(!reason.is_empty());
        assert_eq!(search.sources().count(), 0);
    }
}
