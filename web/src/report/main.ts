import '../shared/tokens.css';
import { pageData } from '../embedded/page_data';
console.log(pageData(document));
